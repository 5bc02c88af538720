#pragma once

#include <limits>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>

namespace pliant {

/// low ≤ X ≤ high in each direction, m. A region is a functor of the middle of an element's nodes at rest that is not
/// negative inside it; the numbers may be packs of elements.
template <int Dim>
struct Box {
  Vector<double, Dim> low, high;

  template <class S>
  PLIANT_HOST_DEVICE S operator()(Vector<S, Dim> const& place) const {
    using T = builtin_scalar<S>;
    S depth(std::numeric_limits<T>::max());
    for (int k = 0; k < Dim; ++k)
      depth = min(depth,
                  min(place[k] - S(static_cast<T>(low[k])), S(static_cast<T>(high[k])) - place[k]));
    return depth;
  }
};
Box(double const (&)[2], double const (&)[2]) -> Box<2>;
Box(double const (&)[3], double const (&)[3]) -> Box<3>;

/// No further from a point than a radius, m.
template <int Dim>
struct Ball {
  Vector<double, Dim> centre;
  double radius;

  template <class S>
  PLIANT_HOST_DEVICE S operator()(Vector<S, Dim> const& place) const {
    using T = builtin_scalar<S>;
    S squared(0);
    for (int k = 0; k < Dim; ++k)
      squared = squared + square(place[k] - S(static_cast<T>(centre[k])));
    return S(static_cast<T>(radius * radius)) - squared;
  }
};
Ball(double const (&)[2], double) -> Ball<2>;
Ball(double const (&)[3], double) -> Ball<3>;

namespace detail {
template <class C, class Region>
struct Inside : SharedUnit<C> {
  std::tuple<C> criteria;
  Region region;

  Inside(C criterion, Region r) : criteria(criterion), region(r) {}
  double least_gradient(double threshold, int dim) const
    requires BoundedCriterion<C>
  {
    return std::get<0>(criteria).least_gradient(threshold, dim);
  }
  double most_gradient(double threshold, int dim) const
    requires BoundedBelowCriterion<C>
  {
    return std::get<0>(criteria).most_gradient(threshold, dim);
  }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    S const depth = region(e.centroid());
    return select(depth < S(0), not_a_number<S>(), S(value_of(std::get<0>(criteria), e)));
  }
};
}  // namespace detail

/// A criterion of the elements of a region: NaN outside it, so that rules pass over the rest and neither shares nor
/// bulks count it. An estimator stays one; its means at nodes are of all elements.
template <class C, class Region>
auto inside(C criterion, Region region) {
  return detail::Inside<C, Region>(criterion, region);
}

}  // namespace pliant
