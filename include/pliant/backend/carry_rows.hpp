#pragma once

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

}  // namespace pliant::detail
