#pragma once

#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// Each criterion for every element of a mesh, written to an array.
namespace pliant::bench {

template <class T, class F, class Criterion>
struct CriterionVisitor {
  static constexpr int counters = 1;
  GroupLaws<T, F> groups;
  Criterion criterion;
  T* values;  // (elements)

  template <class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<0>, V const& rest, V const& u) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto const& law = groups.template law<0>();
    Vector<S, 1> value;
    value[0] = criterion(ElementState<F, std::remove_cvref_t<decltype(law)>, S>{law, rest, u});
    return value;
  }
  template <class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<0>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    values[e] = value[0];
  }
};

template <class F, class Criterion, class B>
void time_criterion(benchmark::State& state, B const& backend, int cells) {
  using T = typename B::scalar;
  auto& p = Problem<B, typename F::element>::of(backend, cells);
  auto values = zeros<T>(backend, static_cast<std::size_t>(p.elements.count()));
  auto counters = zeros<double>(backend, 1);
  CriterionVisitor<T, F, Criterion> const visitor{soft_laws<T, F>(), {}, values.data()};
  measure(state, backend,
          [&] { backend.template visit<1>(p.elements, visitor, counters, p.rest(), p.u()); });
  report(state, p, {.read = 2, .written = 0}, sizeof(T));
}

/// Pairwise: each criterion on each element, in one of the precisions.
inline void add_criteria() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    int criteria = 0;
    auto const on_elements = [&]<class Criterion, class... Es>(Criterion, std::string const& what,
                                                               Es...) {
      auto const one = [&]<class E>(E, bool chosen) {
        using F = Usual<E, SaintVenantKirchhoff>;
        int const cells = usual_cells<E, B>();
        if (chosen)
          add<F, T>(what, name, cells, [backend, cells](benchmark::State& state) {
            time_criterion<F, Criterion>(state, backend, cells);
          });
      };
      int element = criteria++ + (sizeof(T) == 8 ? 1 : 0);
      (one(Es{}, element++ % 2 == 0), ...);
    };
    auto const on_all = [&](auto criterion, std::string const& what) {
      on_elements(criterion, what, Tet4{}, Hex8{}, Tri3{}, Quad4{});
    };
    on_all(EdgeLengthRatio{}, "EdgeLengthRatio");
    on_all(AreaRatio{}, "AreaRatio");
    on_all(AspectRatio{}, "AspectRatio");
    on_all(HarmonicMeanEdge{}, "HarmonicMeanEdge");
    on_all(ForceIntensity<>{}, "ForceIntensity");
    on_all(Rotation{}, "Rotation");
  });
}

}  // namespace pliant::bench
