#pragma once

#include <cmath>

#include <pliant/backend/backend.hpp>
#include <pliant/constraint/condition.hpp>

// Sums and products of vectors over nodes, in the memory of a backend.
namespace pliant::detail {

/// A field times a number.
template <class T, int Dim>
struct Scaled {
  double factor;  // of what is 0 the field is not read: it may have no data
  NodeField<T const, Dim> field;
};

template <class T, int Dim, int Count>
struct SetSum {
  NodeField<T, Dim> out;
  Scaled<T, Dim> terms[Count];
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto sum = Vector<T, Dim>::zero();
    for (auto const& [factor, field] : terms)
      if (factor != 0) sum = sum + static_cast<T>(factor) * field.at(i);
    out.set(i, sum);
  }
};
/// out = Σ factor · field at the nodes [0, n); `out` may be one of them.
template <class B, class T, int Dim, class... Terms>
void set_sum(B const& backend, Index n, NodeField<T, Dim> out, Terms const&... terms) {
  backend.for_each(n, SetSum<T, Dim, int{sizeof...(Terms)}>{out, {terms...}});
}

template <class T, int Dim>
struct DotAt {
  NodeField<T const, Dim> a, b;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    auto const x = a.at(i), y = b.at(i);
    double sum = 0;
    for (int k = 0; k < Dim; ++k) sum += static_cast<double>(x[k]) * static_cast<double>(y[k]);
    return sum;
  }
};
/// |field| over the nodes [0, n), summed in double precision.
template <class B, class T, int Dim>
double norm_of(B const& backend, Index n, NodeField<T, Dim> field) {
  return std::sqrt(backend.sum(n, DotAt<std::remove_const_t<T>, Dim>{{field.data}, {field.data}}));
}

/// Sets what is no unknown to zero: held and driven directions, and nodes of no mass, slaves among them.
template <class T, int Dim>
struct KeepUnknowns {
  NodeField<T, Dim> field;
  T const* mass;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto value = field.at(i);
    for (int k = 0; k < Dim; ++k)
      if (!(mass[i] > T(0)) || (held[i] >> k & 1)) value[k] = T(0);
    field.set(i, value);
  }
};
template <class Parts>
void keep_unknowns(Parts const& parts, typename Parts::Field field) {
  parts.backend.for_each(parts.layout.rows,
                         KeepUnknowns<typename Parts::T, Parts::dim>{
                             field, parts.layout.mass.data(), parts.layout.held.data()});
}
/// How many unknowns a node has.
template <class T, int Dim>
struct CountUnknowns {
  T const* mass;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    int count = 0;
    for (int k = 0; k < Dim; ++k) count += mass[i] > T(0) && !(held[i] >> k & 1);
    return count;
  }
};
template <class Parts>
Index count_unknowns(Parts const& parts) {
  return static_cast<Index>(parts.backend.sum(
      parts.layout.rows, CountUnknowns<typename Parts::T, Parts::dim>{parts.layout.mass.data(),
                                                                      parts.layout.held.data()}));
}

}  // namespace pliant::detail
