#pragma once

#include <array>

#include <pliant/force/force_term.hpp>
#include <pliant/law/parameters.hpp>
#include <pliant/math/dual.hpp>

namespace pliant {

namespace detail {

/// A physics that has a potential: `energy(rest, u)`. Others give `force(rest, u)`.
template <class Physics, class S>
concept HasEnergy = requires(Physics const& p, Matrix<S, Physics::nodes, Physics::dim> const& x) {
  { p.energy(x, x) } -> std::convertible_to<S>;
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

}  // namespace detail

/// A force term of one physics on a list of small sets of nodes: faces under pressure, springs, nodes above
/// a floor. A Physics<T> is an aggregate of parameters of type T, as a law is, with
///   nodes, dim                 of one set
///   energy(rest, u)            J, from (nodes, dim) positions at rest and displacements; or
///   force(rest, u)             (nodes, dim), N, where there is no energy
/// for scalars of every kind: T, packs, dual numbers. All else is derived.
template <Backend B, template <class> class Physics>
class ConnectedTerm : public AnyForceTerm<B, Physics<double>::dim> {
  using Base = AnyForceTerm<B, Physics<double>::dim>;
  static constexpr int Nodes = Physics<double>::nodes, Dim = Physics<double>::dim;
  using Own = Physics<typename B::scalar>;

 public:
  using typename Base::At, typename Base::Field, typename Base::ConstField, typename Base::T,
      typename Base::HostField;

  /// `sets`: internal numbers of nodes, of which there are `nodes`.
  ConnectedTerm(B const& backend, std::vector<std::array<Index, Nodes>> sets,
                Physics<double> const& physics, Index nodes)
      : on_host_(physics),
        physics_(law_cast<typename B::scalar>(physics)),
        sets_(std::move(sets)),
        elements_(backend, sets_, 1, std::vector<Tag>(sets_.size(), 0), nodes) {}

  Index scratch_nodes() const override { return elements_.scratch_nodes(); }
  bool has_energy() const override { return detail::HasEnergy<Own, T>; }
  double energy(B const& backend, At const& at) const override {
    if constexpr (detail::HasEnergy<Own, T>)
      return backend.template sum_elements<1>(elements_, detail::ConnectedEnergy<Own>{physics_},
                                              at.rest, at.u);
    else
      return 0;
  }
  void add_force(B const& backend, At const& at, Field f) const override {
    backend.template accumulate<1>(elements_, detail::ConnectedForce<Own>{physics_}, f, at.rest,
                                   at.u);
  }
  void add_tangent_product(B const& backend, T factor, At const& at, ConstField du,
                           Field f) const override {
    backend.template accumulate<1>(elements_, detail::ConnectedTangent<T, Own>{physics_, factor}, f,
                                   at.rest, at.u, du);
  }
  void add_diagonal(B const& backend, At const& at, int column, Field diagonal) const override {
    backend.template accumulate<1>(elements_, detail::ConnectedDiagonal<Own>{physics_, column},
                                   diagonal, at.rest, at.u);
  }
  void add_row_sums(B const& backend, At const& at, Field rows) const override {
    backend.template accumulate<1>(elements_, detail::ConnectedRowSums<Own>{physics_}, rows,
                                   at.rest, at.u);
  }
  void for_each_element(HostField const& rest, HostField const& u, bool with_stiffness,
                        std::function<void(ElementMatrix const&)> const& visit) const override {
    for (auto const& nodes : sets_) {
      Matrix<double, Nodes, Dim> x, v;
      for (int a = 0; a < Nodes; ++a)
        for (int k = 0; k < Dim; ++k) {
          Index const node = nodes[static_cast<std::size_t>(a)];
          x(a, k) = rest(node)[static_cast<std::size_t>(k)];
          v(a, k) = u(node)[static_cast<std::size_t>(k)];
        }
      auto const f = detail::force_of(on_host_, x, v);
      std::array<double, Nodes * Dim> force;
      std::array<double, Nodes * Dim * Nodes * Dim> stiffness;
      for (int r = 0; r < Nodes * Dim; ++r)
        force[static_cast<std::size_t>(r)] = f(r / Dim, r % Dim);
      for (int c = 0; with_stiffness && c < Nodes * Dim; ++c) {
        auto const df = detail::tangent_column(on_host_, x, v, c / Dim, c % Dim);
        for (int r = 0; r < Nodes * Dim; ++r)
          stiffness[static_cast<std::size_t>(r * Nodes * Dim + c)] = -df(r / Dim, r % Dim);
      }
      double energy = 0;
      if constexpr (detail::HasEnergy<Physics<double>, double>) energy = on_host_.energy(x, v);
      visit({nodes, energy, force,
             with_stiffness ? std::span<double const>(stiffness) : std::span<double const>()});
    }
  }

 private:
  Physics<double> on_host_;
  Own physics_;
  std::vector<std::array<Index, Nodes>> sets_;
  typename B::template Elements<Nodes> elements_;
};

}  // namespace pliant
