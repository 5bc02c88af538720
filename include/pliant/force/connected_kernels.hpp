#pragma once

#include <concepts>

#include <pliant/backend/kernel.hpp>
#include <pliant/math/dual.hpp>

// What backends do with the physics of a set of nodes.
namespace pliant {

namespace detail {

/// A physics that has a potential: `energy(rest, u)`. Others give `force(rest, u)`.
template <class Physics, class S>
concept HasEnergy = requires(Physics const& p, Matrix<S, Physics::nodes, Physics::dim> const& x) {
  { p.energy(x, x) } -> std::convertible_to<S>;
};

template <class Physics, class S>
concept HasForce = requires(Physics const& p, Matrix<S, Physics::nodes, Physics::dim> const& x) {
  { p.force(x, x) } -> std::convertible_to<Matrix<S, Physics::nodes, Physics::dim>>;
};

/// A matrix whose entries vary along another.
template <class S, int N, int D>
PLIANT_HOST_DEVICE Matrix<Dual<S, 1>, N, D> varied(Matrix<S, N, D> const& x,
                                                   Matrix<S, N, D> const& dx) {
  Matrix<Dual<S, 1>, N, D> moving;
  for (int a = 0; a < N; ++a)
    for (int i = 0; i < D; ++i) {
      moving(a, i).value = x(a, i);
      moving(a, i).derivative[0] = dx(a, i);
    }
  return moving;
}
template <class S, int N, int D>
PLIANT_HOST_DEVICE Matrix<S, N, D> derivative_of(Matrix<Dual<S, 1>, N, D> const& x) {
  Matrix<S, N, D> dx;
  for (int a = 0; a < N; ++a)
    for (int i = 0; i < D; ++i) dx(a, i) = x(a, i).derivative[0];
  return dx;
}

/// The forces of a physics: its own, or −∂energy/∂u by dual numbers.
template <class Physics, class S>
PLIANT_HOST_DEVICE Matrix<S, Physics::nodes, Physics::dim> force_of(
    Physics const& p, Matrix<S, Physics::nodes, Physics::dim> const& rest,
    Matrix<S, Physics::nodes, Physics::dim> const& u) {
  if constexpr (HasEnergy<Physics, S>) {
    constexpr int N = Physics::nodes, D = Physics::dim;
    using V = Dual<S, N * D>;
    Matrix<V, N, D> x, v;
    for (int a = 0; a < N; ++a)
      for (int i = 0; i < D; ++i) {
        x(a, i) = V(rest(a, i));
        v(a, i) = V::variable(u(a, i), a * D + i);
      }
    auto const w = p.energy(x, v);
    Matrix<S, N, D> f;
    for (int a = 0; a < N; ++a)
      for (int i = 0; i < D; ++i) f(a, i) = -w.derivative[a * D + i];
    return f;
  } else {
    return p.force(rest, u);
  }
}
/// ∂force/∂u du, by a dual number through the forces.
template <class Physics, class S>
PLIANT_HOST_DEVICE Matrix<S, Physics::nodes, Physics::dim> tangent_product_of(
    Physics const& p, Matrix<S, Physics::nodes, Physics::dim> const& rest,
    Matrix<S, Physics::nodes, Physics::dim> const& u,
    Matrix<S, Physics::nodes, Physics::dim> const& du) {
  auto const at_rest = varied(rest, Matrix<S, Physics::nodes, Physics::dim>::zero());
  return derivative_of(force_of(p, at_rest, varied(u, du)));
}
/// Column (b, k) of ∂force/∂u.
template <class Physics, class M>
PLIANT_HOST_DEVICE M tangent_column(Physics const& p, M const& rest, M const& u, int b, int k) {
  auto du = M::zero();
  du(b, k) = du(b, k) + 1;
  return tangent_product_of(p, rest, u, du);
}

template <class Physics>
struct ConnectedEnergy {
  Physics physics;
  template <class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<0>, V const& rest, V const& u) const {
    return physics.energy(rest, u);
  }
};
template <class Physics>
struct ConnectedForce {
  Physics physics;
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u) const {
    return force_of(physics, rest, u);
  }
};
template <class T, class Physics>
struct ConnectedTangent {
  Physics physics;
  T factor;
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u, V const& du) const {
    return factor * tangent_product_of(physics, rest, u, du);
  }
};
template <class Physics>
struct ConnectedDiagonal {
  Physics physics;
  int column;
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u) const {
    V diagonal;
    for (int a = 0; a < Physics::nodes; ++a) {
      auto const df = tangent_column(physics, rest, u, a, column);
      for (int i = 0; i < Physics::dim; ++i) diagonal(a, i) = -df(a, i);
    }
    return diagonal;
  }
};
template <class Physics>
struct ConnectedRowSums {
  Physics physics;
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u) const {
    auto rows = V::zero();
    for (int b = 0; b < Physics::nodes; ++b)
      for (int k = 0; k < Physics::dim; ++k) {
        auto const df = tangent_column(physics, rest, u, b, k);
        for (int a = 0; a < Physics::nodes; ++a)
          for (int i = 0; i < Physics::dim; ++i) rows(a, i) = rows(a, i) + abs(df(a, i));
      }
    return rows;
  }
};

/// A physics that sees positions in space, where backends keep those relative to the middle of the body.
template <class Physics, class T>
struct InSpace {
  static constexpr int nodes = Physics::nodes, dim = Physics::dim;
  Physics physics;
  Vector<T, dim> origin;

  template <class S>
  PLIANT_HOST_DEVICE Matrix<S, nodes, dim> placed(Matrix<S, nodes, dim> x) const {
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < dim; ++i) x(a, i) = x(a, i) + origin[i];
    return x;
  }
  template <class S>
    requires HasEnergy<Physics, S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, nodes, dim> const& rest,
                              Matrix<S, nodes, dim> const& u) const {
    return physics.energy(placed(rest), u);
  }
  template <class S>
    requires HasForce<Physics, S>
  PLIANT_HOST_DEVICE Matrix<S, nodes, dim> force(Matrix<S, nodes, dim> const& rest,
                                                 Matrix<S, nodes, dim> const& u) const {
    return physics.force(placed(rest), u);
  }
};

}  // namespace detail

}  // namespace pliant
