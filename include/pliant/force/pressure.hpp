#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/element/quadratic_tensor.hpp>
#include <pliant/force/connected_term.hpp>
#include <pliant/formulation/physics.hpp>
#include <pliant/mesh/outer_sides.hpp>

namespace pliant {

namespace detail {

/// A pressure on a face that follows the surface: F_a = −p ∫ N_a n da over the deformed face, N (Hibbitt,
/// International Journal for Numerical Methods in Engineering 14 (1979) 937).
template <int Dim, Element Face>
struct PressureOn {
  template <class T>
  struct physics {
    static constexpr int nodes = Face::nodes, dim = Dim;
    T pressure;  // Pa; positive: against the outward normal

    template <class S>
    PLIANT_HOST_DEVICE Matrix<S, nodes, Dim> force(Matrix<S, nodes, Dim> const& rest,
                                                   Matrix<S, nodes, Dim> const& u) const {
      using Q = Gauss<SimplexCell<typename Face::cell> ? 2 * Face::degree : Face::degree + 1>;
      static constexpr auto table = tabulate<Face, Q, T>();
      auto const x = rest + u;
      auto f = Matrix<S, nodes, Dim>::zero();
      for (int q = 0; q < table.count; ++q) {
        auto tangents = Matrix<S, Dim, Dim - 1>::zero();
        for (int a = 1; a < nodes; ++a)  // of differences: the place in space is not rounded in
          for (int i = 0; i < Dim; ++i)
            for (int k = 0; k < Dim - 1; ++k)
              tangents(i, k) = tangents(i, k) + T(table.gradient[q][a][k]) * (x(a, i) - x(0, i));
        auto const area = area_of(tangents);
        for (int a = 0; a < nodes; ++a)
          for (int i = 0; i < Dim; ++i)
            f(a, i) = f(a, i) - (pressure * T(table.weight[q] * table.shape[q][a])) * area[i];
      }
      return f;
    }
  };
};

/// Whether some element of a mesh has sides of so many nodes.
template <class M, int Nodes>
inline constexpr bool has_sides_with = false;
template <Element... Es, int Nodes>
inline constexpr bool has_sides_with<Mesh<Es...>, Nodes> = ([]<class E>(E*) {
  for (int s = 0; s < static_cast<int>(E::cell::sides().size()); ++s)
    if (mesh::nodes_on_side<E>(s).size() == Nodes) return true;
  return false;
}(static_cast<Es*>(nullptr)) || ...);

/// Calls visit(Face{}, facets) for each kind of face among some facets of a mesh.
template <class M, class Visit>
void for_each_face_type(std::vector<Facet<M::dim>> const& facets, Visit const& visit) {
  auto const of_type = [&]<Element Face>(Face face) {
    if constexpr (has_sides_with<M, Face::nodes>) {
      std::vector<Connectivity<Face>> same;
      for (auto const& facet : facets)
        if (facet.size() == Face::nodes)
          std::copy_n(facet.begin(), Face::nodes, same.emplace_back().begin());
      if (!same.empty()) visit(face, same);
    }
  };
  auto const of_types = [&](auto... faces) { (of_type(faces), ...); };
  if constexpr (M::dim == 2)
    of_types(Line2{}, Line3{});
  else
    of_types(Tri3{}, Quad4{}, Tri6{}, Quad8{}, Quad9{});
}

/// Facets told by their corners as the mesh has them: with all nodes, seen from outside.
template <class M>
std::vector<Facet<M::dim>> outer_facets(M const& mesh, std::vector<Facet<M::dim>> facets) {
  std::map<std::array<Index, 4>, Facet<M::dim>> outer;
  for (auto const& side : mesh::outer_sides(mesh)) outer.emplace(mesh::key_of(side), side);
  for (auto& facet : facets) {
    auto const refuse = [&](char const* why) {
      std::string nodes;
      for (std::size_t a = 0; a < facet.size(); ++a)
        nodes += detail::message({a == 0 ? "" : a + 1 == facet.size() ? " and " : ", ", facet[a]});
      throw Error("body.press: the facet with the nodes ", nodes, why);
    };
    auto const found = outer.find(mesh::key_of(facet));
    if (facet.size() < facet.corners() || found == outer.end())
      refuse(" is not on the boundary of the mesh; give facets of its boundary");
    if (found->second.size() == 0) refuse(" is there twice; give each facet once");
    facet = std::exchange(found->second, {});
  }
  return facets;
}
}  // namespace detail

/// The force terms of a pressure, one for each kind of face. `facets`: internal numbers of nodes.
template <class M, Backend B>
void add_pressure_terms(B const& backend, std::vector<Facet<M::dim>> const& facets, double pascals,
                        Index nodes, std::vector<std::unique_ptr<AnyForceTerm<B, M::dim>>>& terms) {
  detail::for_each_face_type<M>(facets, [&]<class Face>(Face, auto const& faces) {
    using On = detail::PressureOn<M::dim, Face>;
    terms.push_back(std::make_unique<ConnectedTerm<B, On::template physics>>(
        backend, faces, typename On::template physics<double>{pascals}, nodes));
  });
}

}  // namespace pliant
