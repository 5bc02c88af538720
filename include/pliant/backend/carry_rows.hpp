#pragma once

#include <cstddef>
#include <vector>

#include <pliant/backend/backend.hpp>
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
/// to[places[i]] = from[i], except where that is negative.
template <class T, int Dim>
struct PutRows {
  NodeField<T const, Dim> from;
  NodeField<T, Dim> to;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (Index const place = places[i]; place >= 0) to.set(place, from.at(i));
  }
};

/// A field of `nodes` nodes, in a backend's memory: rows of `from` at the places `now`, and value(i, k) at places[i].
template <int Dim, class B, class Array, class Places, class Value>
auto carried_field(B const& backend, Index nodes, Array const& from, Places const& now,
                   std::vector<Index> const& places, Value const& value) {
  using Scalar = typename B::scalar;
  auto field = zeros<Scalar>(
      backend, static_cast<std::size_t>(node_stride) * static_cast<std::size_t>(nodes));
  auto const rows = node_field<Dim>(field);
  backend.for_each(static_cast<Index>(now.size()),
                   PutRows<Scalar, Dim>{node_field<Dim>(from), rows, now.data()});
  std::vector<Scalar> values(node_stride * places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t k = 0; k < std::size_t{Dim}; ++k)
      values[node_stride * i + k] = static_cast<Scalar>(value(i, k));
  auto const own = upload(backend, values);
  auto const at = upload(backend, places);
  backend.for_each(static_cast<Index>(places.size()),
                   PutRows<Scalar, Dim>{node_field<Dim>(own), rows, at.data()});
  return field;
}

/// to[places[i]] = from[i], except where that is negative.
template <class T>
struct PutValues {
  T const* from;
  T* to;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (Index const place = places[i]; place >= 0) to[place] = from[i];
  }
};
/// The same as carried_field of one value per node: value(i) at places[i].
template <class B, class Array, class Places, class Value>
auto carried_values(B const& backend, Index nodes, Array const& from, Places const& now,
                    std::vector<Index> const& places, Value const& value) {
  using Scalar = typename B::scalar;
  auto values = zeros<Scalar>(backend, static_cast<std::size_t>(nodes));
  backend.for_each(static_cast<Index>(now.size()),
                   PutValues<Scalar>{from.data(), values.data(), now.data()});
  std::vector<Scalar> some;
  some.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) some.push_back(value(i));
  auto const own = upload(backend, some);
  auto const at = upload(backend, places);
  backend.for_each(static_cast<Index>(places.size()),
                   PutValues<Scalar>{own.data(), values.data(), at.data()});
  return values;
}

}  // namespace pliant::detail
