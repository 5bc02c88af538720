#pragma once

#include <pliant/backend/value_at.hpp>
#include <pliant/body/velocities.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant {

namespace detail {

/// ‖F‖² + ‖F⁻¹‖² − 2 d in the middle of each element: 0 at rest and under rotation, large where an element is
/// stretched or flattened.
template <class T, class Laws>
struct DistortionVisitor {
  static constexpr int counters = 0;
  T* values;  // (elements)

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const& u) const {
    using E = typename Laws::template formulation<G>::element;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    static constexpr auto table = tabulate<E, Gauss<1>, T>();
    auto const h = RestMap<E, S>::at(Coefficients<E, S>::of(rest), table, 0)
                       .gradient(Coefficients<E, S>::of(u), table, 0);
    auto const c = cofactor_less_identity(h);
    S const j = S(1) + determinant_less_one(h);
    S const squared = dot(h, h) + S(2) * trace(h), inverse = dot(c, c) + S(2) * trace(c);
    // ‖F‖² = d + squared; ‖cof F‖² = d + inverse
    Vector<S, 1> value;
    value[0] = squared + (S(E::dim) + inverse) / (j * j) - S(E::dim);
    return value;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    values[e] = value[0];
  }
};

}  // namespace detail

namespace detail {
/// Leaves the distortion of each element that is awake in its table's scratch.
template <class Parts, class Table>
void evaluate_distortion(Parts& parts, Table& table) {
  using T = typename Parts::T;
  if (table.scratch.size() == 0)
    table.scratch = zeros<T>(parts.backend, static_cast<std::size_t>(table.count()));
  parts.backend.template visit<Table::groups>(
      parts.awake_in(table), DistortionVisitor<T, typename Table::Laws>{table.scratch.data()},
      parts.no_counters, parts.rest(), std::as_const(parts).u());
}
}  // namespace detail

/// The largest distortion of an element that is awake, ‖F‖² + ‖F⁻¹‖² − 2 d in its middle.
template <class Parts>
double largest_distortion(Parts& parts) {
  double largest = 0;
  parts.for_each_type([&](auto& table, auto&) {
    if (table.count() == 0) return;
    detail::evaluate_distortion(parts, table);
    largest = std::max(largest, detail::largest_of(parts.backend, parts.awake_in(table),
                                                   std::as_const(table.scratch).data()));
  });
  return largest;
}

}  // namespace pliant
