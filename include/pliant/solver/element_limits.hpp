#pragma once

#include <cmath>

#include <pliant/solver/stable_step.hpp>

// How long a step each element takes by itself.
namespace pliant {

namespace detail {

/// The largest row sum over mass of a node's free directions, times a factor, in place of its rows.
template <class T, int Dim>
struct RowsToQuotient {
  RowOverMass<T, Dim> quotient;
  NodeField<T, 1> to;
  double factor;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    to(i, 0) = static_cast<T>(factor * quotient(i));
  }
};

/// Adds to each element the largest value of its nodes.
template <class T>
struct AddLargestOfNodes {
  static constexpr int counters = 0;
  T* values;  // (elements)

  template <int G, class S, int N>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Matrix<S, N, 1> const& x) const {
    Vector<S, 1> largest;
    largest[0] = x(0, 0);
    for (int a = 1; a < N; ++a) largest[0] = max(largest[0], x(a, 0));
    return largest;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& largest, Again const&,
                                 Tally const&) const {
    values[e] = values[e] + largest[0];
  }
};

/// A field of one value per node, in the memory that is there for row sums.
template <class Parts>
NodeField<typename Parts::T, 1> node_scratch(Parts& parts) {
  using T = typename Parts::T;
  if (parts.row_sums.size() != parts.layout.f.size())
    parts.row_sums = zeros<T>(parts.backend, parts.layout.f.size());
  return {parts.row_sums.data()};
}

/// How a node's mass is shared out to the elements around it: what each brings, or in proportion to the sums of
/// absolute values of its rows of stiffness. Bounds hold as long as all elements share alike.
enum class MassShares { own, by_rows };

/// Leaves in each table's scratch a bound of the square of the highest frequency of each element with its share
/// of mass, λ_max(M_e⁻¹ K_e), 1/s². With its own share that is the element's eigenvalue (Irons and Treharne
/// 1971), and terms beside the elements, which have no mass, add at most max_i D_i/m_i where D_i are
/// their row sums, if each element takes its share of D_i by mass. With shares by rows it is
/// max_i R_i/m_i over its nodes, where R_i = Σ_e Σ_j |K_e,ij| (unassembled Gershgorin discs). Returns the
/// largest. Throws Error when it is not finite.
template <class Parts>
double bound_elements(Parts& parts, MassShares shares) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& backend = parts.backend;
  auto const at = std::as_const(parts).here();
  bool const by_rows = shares == MassShares::by_rows;
  bool const uses_rows = by_rows || !parts.pressures.empty() || !parts.terms.empty();
  auto const quotient = node_scratch(parts);
  // Of weights at hanging nodes; see stable_step_of. As if masses were smaller.
  double const magnitude = parts.layout.interpolation.magnitude();
  if (uses_rows) {
    NodeField<T, dim> const rows{parts.row_sums.data()};
    clear_rows(parts, rows);
    for_each_added_term(parts, [&](auto const& term) { term.add_row_sums(backend, at, rows); });
    if (by_rows) parts.elements().add_row_sums(backend, at, rows);
    parts.layout.interpolation.hand_on_magnitudes(backend, rows);
    backend.for_each(
        parts.layout.rows,
        RowsToQuotient<T, dim>{{{rows.data}, parts.layout.mass.data(), parts.layout.held.data()},
                               quotient,
                               magnitude});
    parts.layout.interpolation.raise_slaves(backend, quotient);
  }
  double largest = 0;
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0) return;
    if (table.scratch.size() == 0)
      table.scratch = zeros<T>(backend, static_cast<std::size_t>(table.count()));
    backend.for_each(table.count(), FillValue<T>{table.scratch.data(), T(0)});
    if (!by_rows)
      backend.template visit<Table::groups>(
          table.elements,
          ElementSpectra<T, typename Table::Laws>{
              table.laws, static_cast<T>(parts.material.density / (magnitude * magnitude)),
              table.scratch.data()},
          parts.no_counters, at.rest, at.u);
    if (uses_rows)
      backend.template visit<Table::groups>(
          table.elements, AddLargestOfNodes<T>{table.scratch.data()}, parts.no_counters,
          NodeField<T const, 1>{quotient.data});
    largest = std::max(largest, backend.maximum(table.count(), ValueAt<T>{table.scratch.data()}));
  });
  if (!std::isfinite(largest) || !(largest > 0))
    throw Error("LocalSteps: the stiffness of the body is ", largest > 0 ? "not finite" : "zero",
                " at time ", parts.state.time, " s; an element has collapsed");
  return largest;
}

}  // namespace detail
}  // namespace pliant
