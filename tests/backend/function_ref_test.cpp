#include <concepts>
#include <stdexcept>

#include <catch2/catch.hpp>

#include <pliant/backend/function_ref.hpp>

using pliant::FunctionRef;

namespace {
int twice(FunctionRef<int(int)> f, int x) { return f(f(x)); }
}  // namespace

TEST_CASE("a reference to a function calls the object itself") {
  int calls = 0;
  auto const add = [&calls](int x) {
    ++calls;
    return x + 3;
  };
  CHECK(twice(add, 1) == 7);
  CHECK(calls == 2);
}

TEST_CASE("a reference to a function refers to no copy") {
  struct Counter {
    mutable int count = 0;
    void operator()() const { ++count; }
  };
  Counter const counter;
  FunctionRef<void()> const first = counter, second = first;
  first();
  second();
  CHECK(counter.count == 2);
}

TEST_CASE("a reference to a function lets exceptions through") {
  auto const fail = [] { throw std::runtime_error("here"); };
  CHECK_THROWS_AS(FunctionRef<void()>(fail)(), std::runtime_error);
}

TEST_CASE("what cannot be called with the arguments is no function to refer to") {
  auto const of_text = [](char const*) {};
  STATIC_REQUIRE_FALSE(std::constructible_from<FunctionRef<void(int)>, decltype(of_text)>);
}
