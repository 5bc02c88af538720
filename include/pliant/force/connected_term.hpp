#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/body/when_asked.hpp>
#include <pliant/force/connected_kernels.hpp>
#include <pliant/force/force_term.hpp>
#include <pliant/law/parameters.hpp>

namespace pliant {

/// What a ConnectedTerm takes, with parameters of type double: an energy or forces of a set of nodes.
template <class P>
concept NodalPhysics = requires {
  { P::nodes } -> std::convertible_to<int>;
  { P::dim } -> std::convertible_to<int>;
} && (detail::HasEnergy<P, double> || detail::HasForce<P, double>);

/// A force term of one physics on a list of small sets of nodes: faces under pressure, springs, nodes above
/// a floor. A Physics<T> is an aggregate of parameters of type T, as a law is, with
///   nodes, dim                 of one set
///   energy(rest, u)            J, from (nodes, dim) positions at rest and displacements, m; or
///   force(rest, u)             (nodes, dim), N, where there is no energy
/// for scalars of every kind: T, packs, dual numbers. All else is derived.
template <Backend B, template <class> class Physics>
  requires NodalPhysics<Physics<double>>
class ConnectedTerm : public AnyForceTerm<B, Physics<double>::dim> {
  using Base = AnyForceTerm<B, Physics<double>::dim>;
  static constexpr int Nodes = Physics<double>::nodes, Dim = Physics<double>::dim;
  using Own = detail::InSpace<Physics<typename B::scalar>, typename B::scalar>;
  using OnHost = detail::InSpace<Physics<double>, double>;
  using Sets = std::vector<std::array<Index, Nodes>>;

 public:
  using Elements = typename B::template Elements<Nodes>;
  using typename Base::At, typename Base::Field, typename Base::ConstField, typename Base::T,
      typename Base::HostField;

  /// `sets`: internal numbers of nodes, of which there are `nodes`. `origin`: the place in space, m, that
  /// positions are relative to (layout.middle); zero for a physics of differences alone.
  ConnectedTerm(B const& backend, Sets sets, Physics<double> const& physics, Index nodes,
                Point<Dim> const& origin = {})
      : ConnectedTerm(sets, Elements(backend, sets, 1, std::vector<Tag>(sets.size(), 0), nodes),
                      physics, origin) {}
  /// The same where rows of nodes are in the backend's memory: (sets, row_width<Elements>).
  static std::unique_ptr<ConnectedTerm> of_rows(B const& backend,
                                                typename B::template Array<Index> rows,
                                                Physics<double> const& physics, Index nodes,
                                                Point<Dim> const& origin = {}) {
    auto sets = sets_of(backend, rows);
    return std::unique_ptr<ConnectedTerm>(new ConnectedTerm(
        std::move(sets), elements_of_rows<Elements>(backend, std::move(rows), 1, {}, nodes),
        physics, origin));
  }

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
    for (auto const& nodes : *sets_) {
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
      if constexpr (detail::HasEnergy<OnHost, double>) energy = on_host_.energy(x, v);
      visit({nodes, energy, force,
             with_stiffness ? std::span<double const>(stiffness) : std::span<double const>()});
    }
  }

 private:
  ConnectedTerm(WhenAsked<Sets> sets, Elements elements, Physics<double> const& physics,
                Point<Dim> const& origin)
      : on_host_{physics, vector_of<double>(origin)},
        physics_{law_cast<typename B::scalar>(physics), vector_of<typename B::scalar>(origin)},
        sets_(std::move(sets)),
        elements_(std::move(elements)) {}
  /// Read when they are asked for.
  static WhenAsked<Sets> sets_of(B const& backend, typename B::template Array<Index> const& rows) {
    auto kept =
        std::make_shared<typename B::template Array<Index>>(unset<Index>(backend, rows.size()));
    detail::copy_values<B, Index>(backend, rows.data(), kept->data(), rows.size());
    return WhenAsked<Sets>::by([kept] {
      auto const all = download<Index>(*kept);
      auto sets = std::make_shared<Sets>(all.size() / row_width<Elements>);
      for (std::size_t k = 0; k < sets->size(); ++k)
        std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(k * row_width<Elements>), Nodes,
                    (*sets)[k].begin());
      return sets;
    });
  }
  template <class S>
  static Vector<S, Dim> vector_of(Point<Dim> const& x) {
    Vector<S, Dim> v;
    for (int k = 0; k < Dim; ++k) v[k] = static_cast<S>(x[static_cast<std::size_t>(k)]);
    return v;
  }

  OnHost on_host_;
  Own physics_;
  WhenAsked<Sets> sets_;
  Elements elements_;
};

}  // namespace pliant
