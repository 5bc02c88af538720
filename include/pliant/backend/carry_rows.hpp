#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/field.hpp>

namespace pliant::detail {

/// to[i] = from[places[i]].
template <class T, int Dim>
struct TakeRows {
  NodeField<T const, Dim> from;
  NodeField<T, Dim> to;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to.set(i, from.at(places[i])); }
};
/// to[places[i]] = from[i].
template <class T, int Dim>
struct PutRows {
  NodeField<T const, Dim> from;
  NodeField<T, Dim> to;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to.set(places[i], from.at(i)); }
};

/// An array of `count` values: those of another one, as far as there are some, and 0 behind them.
template <class U, class B, class Array>
auto lengthened(B const& backend, Array const& from, std::size_t count) {
  auto array = unset<U>(backend, count);
  std::size_t const kept = std::min(count, from.size());
  copy_values(backend, from.data(), array.data(), kept);
  clear_values(backend, array.data() + kept, count - kept);
  return array;
}

/// A field of `rows` rows, in a backend's memory: those of `from`, but value(i, k) in the row places[i], and 0 in the rows
/// `freed` and in those that `from` has not.
template <int Dim, class B, class Array, class Value>
auto carried_field(B const& backend, Index rows, Array const& from, std::vector<Index> const& freed,
                   std::vector<Index> places, Value const& value) {
  using Scalar = typename B::scalar;
  auto field = lengthened<Scalar>(
      backend, from, static_cast<std::size_t>(node_stride) * static_cast<std::size_t>(rows));
  std::vector<Scalar> values(node_stride * (places.size() + freed.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t k = 0; k < std::size_t{Dim}; ++k)
      values[node_stride * i + k] = static_cast<Scalar>(value(i, k));
  places.insert(places.end(), freed.begin(), freed.end());
  auto const own = upload(backend, values);
  auto const at = upload(backend, places);
  backend.for_each(static_cast<Index>(places.size()),
                   PutRows<Scalar, Dim>{node_field<Dim>(own), node_field<Dim>(field), at.data()});
  return field;
}

/// to[places[i]] = from[i].
template <class T>
struct PutValues {
  T const* from;
  T* to;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[places[i]] = from[i]; }
};
/// The same as carried_field of one value per node: value(i) at places[i].
template <class B, class Array, class Value>
auto carried_values(B const& backend, Index rows, Array const& from,
                    std::vector<Index> const& freed, std::vector<Index> places,
                    Value const& value) {
  using Scalar = typename B::scalar;
  auto values = lengthened<Scalar>(backend, from, static_cast<std::size_t>(rows));
  std::vector<Scalar> some(places.size() + freed.size(), Scalar(0));
  for (std::size_t i = 0; i < places.size(); ++i) some[i] = value(i);
  places.insert(places.end(), freed.begin(), freed.end());
  auto const own = upload(backend, some);
  auto const at = upload(backend, places);
  backend.for_each(static_cast<Index>(places.size()),
                   PutValues<Scalar>{own.data(), values.data(), at.data()});
  return values;
}

}  // namespace pliant::detail
