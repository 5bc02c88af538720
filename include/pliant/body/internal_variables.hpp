#pragma once

#include <pliant/body/point_visitors.hpp>
#include <pliant/force/forces.hpp>

// What quadrature points keep from step to step: their step size, committing and equilibrating them.
namespace pliant {

/// The laws of a table's groups when `step` s have passed since internal variables were committed.
template <class Parts, class Table>
auto laws_over(Parts const& parts, Table const& table, double step) {
  auto laws = table.laws;
  auto const prepare = [&]<class F>(F const*, auto& law) {
    if constexpr (internal_variables_of<F> > 0)
      law = prepared<F>(law_cast<typename Parts::T>(parts.template law_of<F>()), step);
  };
  [&]<int... G>(std::integer_sequence<int, G...>) {
    (prepare(static_cast<typename Table::template formulation<G> const*>(nullptr),
             std::get<G>(laws.laws)),
     ...);
  }(std::make_integer_sequence<int, Table::groups>());
  return laws;
}

/// Laws with internal variables see time steps of this size, s, since they were committed.
template <class Parts>
void set_step_size(Parts& parts, double step) {
  if (!Parts::has_internal_variables || step == parts.state.step_size) return;
  parts.state.step_size = step;
  parts.for_each_type([&](auto& table, auto&) { table.laws = laws_over(parts, table, step); });
  forget_forces(parts);
  ++parts.revision;
}

/// Laws see another time step for as long as this lives.
template <class Parts>
class WithStepSize {
 public:
  WithStepSize(Parts& parts, double step) : parts_(parts), before_(parts.state.step_size) {
    set_step_size(parts, step);
  }
  WithStepSize(WithStepSize const&) = delete;
  ~WithStepSize() { set_step_size(parts_, before_); }

 private:
  Parts& parts_;
  double before_;
};

/// Brings internal variables of elements of a table up to displacements u.
template <class Parts, class Elements, class Laws>
void commit_by(Parts& parts, Elements const& elements, Laws const& laws,
               typename Parts::ConstField u) {
  if constexpr (Laws::internal_variable_count > 0)
    parts.backend.template visit<std::tuple_size_v<decltype(laws.laws)>>(
        elements, CommitVisitor<typename Parts::T, Laws>{laws}, parts.no_counters, parts.rest(), u);
}
/// The same of elements_of(table).
template <class Parts, class ElementsOf>
void commit_of(Parts& parts, typename Parts::ConstField u, ElementsOf const& elements_of) {
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if constexpr (Table::Laws::internal_variable_count > 0)
      commit_by(parts, elements_of(table), table.laws, u);
  });
}
/// The same of those that are awake; see relax_what_sleeps.
template <class Parts>
void commit_at(Parts& parts, typename Parts::ConstField u) {
  commit_of(parts, u, [&](auto const& table) { return parts.awake_in(table); });
}

/// Brings internal variables to rest: as if the body had always been where it is.
template <class Parts>
void equilibrate(Parts& parts) {
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if constexpr (Table::Laws::internal_variable_count > 0)
      parts.backend.template visit<Table::groups>(
          table.elements,
          CarryInternalVariables<typename Parts::T, typename Table::Laws>{table.laws, nullptr},
          parts.no_counters, parts.rest(), std::as_const(parts).u());
  });
}

}  // namespace pliant
