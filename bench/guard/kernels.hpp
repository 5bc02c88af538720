#pragma once

#include "support/formulations.hpp"
#include "support/problem.hpp"

// The kernels whose instructions and registers are compared with the committed figures.
namespace pliant::bench {

template <class T, Element E>
struct Guarded {
  using scalar = T;
  using formulation = Usual<E, SaintVenantKirchhoff>;
};

/// Calls visit(Guarded<T, E>) for each element and precision.
template <class Visit>
void on_each_guarded(Visit const& visit) {
  auto const both = [&]<Element... E>(Guarded<double, E>...) {
    (visit(Guarded<float, E>{}), ...);
    (visit(Guarded<double, E>{}), ...);
  };
  both(Guarded<double, Quad4>{}, Guarded<double, Quad9>{}, Guarded<double, Tet4>{},
       Guarded<double, Tet10>{}, Guarded<double, Hex8>{}, Guarded<double, Hex20>{},
       Guarded<double, Hex27>{});
}

template <class F, class B>
void add_force(B const& backend, Problem<B, typename F::element>& p) {
  using Laws = GroupLaws<typename B::scalar, F>;
  ForceKernel<Laws> const kernel{soft_laws<typename B::scalar, F>()};
  backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u());
}
template <class F, class B>
void add_tangent(B const& backend, Problem<B, typename F::element>& p) {
  using T = typename B::scalar;
  TangentKernel<T, GroupLaws<T, F>> const kernel{soft_laws<T, F>(), T(1)};
  backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u(), p.du());
}

}  // namespace pliant::bench
