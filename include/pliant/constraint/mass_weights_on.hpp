#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/constraint/interpolation_on.hpp>
#include <pliant/math/uncontracted.hpp>

namespace pliant {

namespace detail {

/// See Interpolation::mass_weight.
struct MassWeight {
  double const* magnitude;  // by the slave's row; null where no weight is negative

  PLIANT_HOST_DEVICE Uncontracted operator()(Index slave, double weight) const {
    double const positive = abs(weight);
    if (magnitude == nullptr) return positive;
    return Uncontracted(positive) / Uncontracted(magnitude[slave]);
  }
};
template <class T>
struct MagnitudesByRow {
  MagnitudeOfRow<T> of;
  Index const* node;
  double* magnitude;
  PLIANT_HOST_DEVICE void operator()(Index k) const { magnitude[node[k]] = of(k); }
};

/// Sets a slave to the mean of its masters.
template <class T, int C, class Values>
struct MeanOfMasters {
  MassWeight mass_weight;
  Index const *node, *first, *other;
  T const* weight;
  Values values;

  PLIANT_HOST_DEVICE void operator()(Index s) const {
    using S = Uncontracted;
    for (int k = 0; k < C; ++k) {
      S const base = values(other[first[s]], k);
      S sum = base;
      for (Index j = first[s]; j < first[s + 1]; ++j)
        sum += mass_weight(node[s], static_cast<double>(weight[j])) * (values(other[j], k) - base);
      values(node[s], k) = sum.value;
    }
  }
};
/// Adds to a master what it has of its slaves.
template <class T, int C, class Values>
struct TakeFromSlaves {
  MassWeight mass_weight;
  Index const *node, *first, *other;
  T const* weight;
  Values values;

  PLIANT_HOST_DEVICE void operator()(Index m) const {
    using S = Uncontracted;
    for (int k = 0; k < C; ++k) {
      S sum = values(node[m], k);
      for (Index j = first[m]; j < first[m + 1]; ++j)
        sum += mass_weight(other[j], static_cast<double>(weight[j])) * S(values(other[j], k));
      values(node[m], k) = sum.value;
    }
  }
};
template <int C, class Values>
struct ClearSlave {
  Index const* node;
  Values values;
  PLIANT_HOST_DEVICE void operator()(Index s) const {
    for (int k = 0; k < C; ++k) values(node[s], k) = 0;
  }
};

/// C doubles by row.
template <int C>
struct DoublesByRow {
  double* data;  // (rows, C)
  PLIANT_HOST_DEVICE double& operator()(Index row, int k) const {
    return data[static_cast<std::ptrdiff_t>(C) * row + k];
  }
};

}  // namespace detail

/// An interpolation in a backend's memory by the weights of masses (see Interpolation::mass_weight): what of the mass of a slave
/// its masters have. Refers to the interpolation. Values are such that values(row, k) is a reference to a double, for the
/// rows of slaves and their masters.
template <Backend B>
class MassWeightsOn {
  using T = typename B::scalar;

 public:
  /// `rows`: how many there are of nodes.
  MassWeightsOn(B const& backend, InterpolationOn<B> const& interpolation, Index rows)
      : backend_(backend), interpolation_(interpolation) {
    if (!(interpolation.magnitude() > 1)) return;
    auto const& slaves = interpolation.slaves();
    magnitude_ = zeros<double>(backend, static_cast<std::size_t>(rows));
    backend.for_each(slaves.count,
                     detail::MagnitudesByRow<T>{
                         detail::MagnitudeOfRow<T>{slaves.first.data(), slaves.weight.data()},
                         slaves.node.data(), magnitude_.data()});
  }

  InterpolationOn<B> const& interpolation() const { return interpolation_; }
  /// Sets slaves to the mean of their masters: to the velocity at which their mass moves.
  template <int C, class Values>
  void apply(Values const& values) const {
    applying<C>(values).run(backend_);
  }
  /// Hands what slaves hold to their masters, and sets slaves to zero. A master adds up by ascending slaves.
  template <int C, class Values>
  void hand(Values const& values) const {
    if (!interpolation_.empty()) detail::in_turn(backend_, handing<C>(values), clearing<C>(values));
  }

  // The same as steps of loops (see in_turn).

  template <int C, class Values>
  [[nodiscard]] detail::LoopStep<detail::MeanOfMasters<T, C, Values>> applying(
      Values const& values) const {
    auto const& rows = interpolation_.slaves();
    return {rows.count,
            {weight(), rows.node.data(), rows.first.data(), rows.other.data(), rows.weight.data(),
             values}};
  }
  template <int C, class Values>
  [[nodiscard]] detail::LoopStep<detail::TakeFromSlaves<T, C, Values>> handing(
      Values const& values) const {
    auto const& rows = interpolation_.masters();
    return {rows.count,
            {weight(), rows.node.data(), rows.first.data(), rows.other.data(), rows.weight.data(),
             values}};
  }
  template <int C, class Values>
  [[nodiscard]] detail::LoopStep<detail::ClearSlave<C, Values>> clearing(
      Values const& values) const {
    auto const& rows = interpolation_.slaves();
    return {rows.count, {rows.node.data(), values}};
  }

 private:
  detail::MassWeight weight() const {
    return detail::MassWeight{magnitude_.size() == 0 ? nullptr : magnitude_.data()};
  }

  B backend_;
  InterpolationOn<B> const& interpolation_;
  typename B::template Array<double>
      magnitude_;  // by the row of a slave; empty: no weight is negative
};

}  // namespace pliant
