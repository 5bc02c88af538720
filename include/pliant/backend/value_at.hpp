#pragma once

#include <limits>

#include <pliant/backend/patch_list.hpp>
#include <pliant/backend/patch_ranges.hpp>
#include <pliant/math/functions.hpp>

namespace pliant::detail {

PLIANT_HOST_DEVICE bool is_finite(double x) { return abs(x) <= std::numeric_limits<double>::max(); }
/// NaN must propagate through a maximum: what is not finite counts as infinite.
PLIANT_HOST_DEVICE double infinite_if_not_finite(double x) {
  return is_finite(x) ? x : std::numeric_limits<double>::infinity();
}
/// Work that is not finite is not booked.
PLIANT_HOST_DEVICE double zero_if_not_finite(double x) { return is_finite(x) ? x : 0.0; }

/// The values of an array, for maximum and sum.
template <class T>
struct ValueAt {
  T const* data;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return infinite_if_not_finite(static_cast<double>(data[i]));
  }
};

/// The same of the elements of a list's patches, one after another.
template <class T>
struct ListedValueAt {
  ValueAt<T> values;
  Index const* list;  // see over
  PatchRanges patches;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    constexpr double none = -std::numeric_limits<double>::infinity();
    Index const k = i / patches.size;
    if (k >= list[0]) return none;
    Index const patch = list[k + 1], e = patches.first[patch] + i % patches.size;
    return e < patches.first[patch + 1] ? values(e) : none;
  }
};

/// The largest of the values of some elements; -infinity where there are none.
template <class B, class Elements, class T>
double largest_of(B const& backend, ActiveElements<Elements> const& some, T const* values) {
  ValueAt<T> const at{values};
  if (some.list == nullptr) return backend.maximum(some.elements.count(), at);
  PatchRanges const patches = some.elements.patches();
  return backend.maximum(some.most * patches.size, ListedValueAt<T>{at, some.list, patches});
}

template <class T>
struct FillValue {
  T* values;
  T value;
  PLIANT_HOST_DEVICE void operator()(Index i) const { values[i] = value; }
};

}  // namespace pliant::detail
