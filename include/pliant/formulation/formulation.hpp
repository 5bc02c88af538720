#pragma once

#include <pliant/element/element.hpp>
#include <pliant/law/law.hpp>
#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// Element × quadrature × law: the thing that has forces. A type only; the parameters of the law
/// live in the group.
template <Element E, class Q, template <class> class L>
  requires QuadratureOn<Q, typename E::cell> && Law<L<double>>
struct Formulation {
  using element = E;
  using quadrature = Q;
  template <class T>
  using law = L<T>;
  static constexpr int dim = E::dim, nodes = E::nodes;
  static constexpr int points = Tabulation<E, Q, double>::count;
};

}  // namespace pliant
