#pragma once

#include <concepts>

namespace pliant {

/// Refers to a function object that outlives it, of whatever type: what calls it is compiled once, and not for each
/// of these. It costs a call through a pointer, and one function to compile where std::function takes ten.
template <class Signature>
class FunctionRef;

template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  template <class F>
    requires(!std::same_as<F, FunctionRef> && std::invocable<F const&, Arguments...>)
  [[gnu::always_inline]] FunctionRef(F const& f) : object_(&f), call_(call<F>) {}
  [[gnu::always_inline]] Result operator()(Arguments... arguments) const {
    return call_(object_, static_cast<Arguments>(arguments)...);
  }

 private:
  template <class F>
  static Result call(void const* object, Arguments... arguments) {
    return (*static_cast<F const*>(object))(static_cast<Arguments>(arguments)...);
  }

  void const* object_;
  Result (*call_)(void const*, Arguments...);
};

}  // namespace pliant
