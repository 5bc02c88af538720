#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>

// Arrays that grow by factors, so that lists of changing length ask for memory seldom.
namespace pliant::detail {

template <class Array>
using ValueOf = std::remove_pointer_t<decltype(std::declval<Array&>().data())>;

/// Makes an array no shorter than `count`; where it grows, what it held is lost, and its values are not set.
template <Backend B, class Array>
void grow(B const& backend, Array& array, std::size_t count) {
  if (array.size() < count) array = unset<ValueOf<Array>>(backend, count + count / 2);
}
/// The same, but where it grows, all values are zero.
template <Backend B, class Array>
void grow_zeroed(B const& backend, Array& array, std::size_t count) {
  if (array.size() < count) array = zeros<ValueOf<Array>>(backend, count + count / 2);
}
/// The same, but the first `kept` values stay, and where it grows, those behind them are zero.
template <Backend B, class Array>
void grow_keeping(B const& backend, Array& array, std::size_t kept, std::size_t count) {
  if (array.size() >= count) return;
  auto longer = zeros<ValueOf<Array>>(backend, count + count / 2);
  copy_values<B, ValueOf<Array>>(backend, array.data(), longer.data(), kept);
  array = std::move(longer);
}

}  // namespace pliant::detail
