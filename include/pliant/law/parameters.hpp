#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <pliant/error.hpp>

namespace pliant {

namespace detail {
/// One T, the `I`th of a list.
template <class T, std::size_t I>
T const& one_of_many();
template <class L, class T, std::size_t... I>
constexpr bool made_of(std::index_sequence<I...>) {
  return requires { L{one_of_many<T, I>()...}; };  // braces refuse a T for a member that is no T
}
}  // namespace detail

/// How many numbers the parameters of a law L<T> are.
template <class Law, class T>
inline constexpr std::size_t parameter_count = std::is_empty_v<Law> ? 0 : sizeof(Law) / sizeof(T);

/// The parameters of a law as a list of numbers.
template <template <class> class L, class T>
auto parameters(L<T> const& law) {
  constexpr std::size_t count = parameter_count<L<T>, T>;
  if constexpr (count == 0) {
    return std::array<T, 0>{};
  } else {
    static_assert(sizeof(L<T>) == count * sizeof(T) &&
                      detail::made_of<L<T>, T>(std::make_index_sequence<count>()),
                  "every member of a law L<T> must be of type T, or an array of T");
    return std::bit_cast<std::array<T, count>>(law);
  }
}

/// The same law with its parameters in another precision. Throws Error where that cannot hold one of them:
/// where it is not finite, or 0 while the parameter is not.
template <class To, template <class> class L, class From>
L<To> law_cast(L<From> const& law) {
  auto const from = parameters(law);
  if constexpr (from.size() == 0) {
    return {};
  } else {
    std::array<To, from.size()> to;
    for (std::size_t k = 0; k < from.size(); ++k) {
      to[k] = static_cast<To>(from[k]);
      if (!std::isfinite(to[k]) || (to[k] == 0 && from[k] != 0))
        throw Error("law_cast: parameter ", k, " of a law is ", from[k], ", which ", 8 * sizeof(To),
                    " bits cannot hold; take double, or other units");
    }
    static_assert(sizeof(L<To>) == sizeof(to), "a law L<T> has the same members for each T");
    return std::bit_cast<L<To>>(to);
  }
}

}  // namespace pliant
