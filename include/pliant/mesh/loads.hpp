#pragma once

#include <concepts>
#include <map>
#include <vector>

#include <pliant/element/linear.hpp>
#include <pliant/formulation/kinematics.hpp>
#include <pliant/mesh/sides.hpp>
#include <pliant/quadrature/gauss.hpp>

// Nodal forces that do the work of distributed ones, for Body::set_loads: ∫ N_a b dV, ∫ N_a t dA with the
// element's own shape functions, curved sides included. In 2D per thickness. A load is a value, or a
// function of the place at rest that gives one: Point -> Point, or Point -> double for a pressure.
namespace pliant {

namespace detail {

template <class Load, std::size_t Dim>
auto load_at(Load const& load, std::array<double, Dim> const& place) {
  if constexpr (std::invocable<Load const&, std::array<double, Dim> const&>)
    return load(place);
  else
    return load;
}

/// A point of a side of an element: shape functions of all its nodes, and their slopes along the side.
template <Element E>
struct SidePoint {
  Vector<double, E::nodes> shape;
  Matrix<double, E::nodes, E::dim - 1> slope;
  double weight;

  Point<E::dim> place(Nodal<E, double> const& x) const {
    Point<E::dim> p{};
    for (int a = 0; a < E::nodes; ++a)
      for (int i = 0; i < E::dim; ++i) p[static_cast<std::size_t>(i)] += shape[a] * x(a, i);
    return p;
  }
  /// The area that the point stands for, as a vector that points outwards.
  Vector<double, E::dim> area(Nodal<E, double> const& x) const {
    return weight * area_of(transpose(x) * slope);
  }
};

/// Points that integrate N_a times a load of the element's degree, and some more.
template <Element E>
std::vector<SidePoint<E>> side_points(int side) {
  constexpr int dim = E::dim, n = E::degree + 2;
  constexpr std::size_t most_corners = E::cell::sides()[0].size();
  auto const corners = E::cell::sides()[static_cast<std::size_t>(side)];
  std::vector<SidePoint<E>> points;
  auto const add = [&]<int C>(Vector<double, C> const& shares,
                              Matrix<double, C, dim - 1> const& slopes, double weight) {
    Matrix<double, C, dim> places;  // of the side's corners on the cell
    for (int c = 0; c < C; ++c)
      for (int i = 0; i < dim; ++i)
        places(c, i) = E::cell::corner(corners[static_cast<std::size_t>(c)])[i];
    Vector<double, dim> const xi = transpose(places) * shares;
    points.push_back({E::shape(xi), shape_gradient<E>(xi) * (transpose(places) * slopes), weight});
  };
  [[maybe_unused]] auto const on_face = [&]<Element Face>(Face, auto const& rule) {
    for (int q = 0; q < rule.count; ++q) {
      Vector<double, 2> const at{{{rule.points[q][0]}, {rule.points[q][1]}}};
      add(Face::shape(at), shape_gradient<Face>(at), rule.weights[q]);
    }
  };
  if constexpr (dim == 2) {
    auto const rule = gauss_jacobi<n>();
    for (int q = 0; q < rule.count; ++q) {
      double const s = rule.points[q][0];
      add(Vector<double, 2>{{{(1 - s) / 2}, {(1 + s) / 2}}}, Matrix<double, 2, 1>{{{-0.5}, {0.5}}},
          rule.weights[q]);
    }
  } else if constexpr (most_corners == 3) {
    on_face(Tri3{}, triangle_rule<2 * E::degree + 2>());
  } else if (corners.back() < 0) {
    on_face(Tri3{}, triangle_rule<2 * E::degree + 2>());
  } else {
    on_face(Quad4{}, tensor_product<2>(gauss_jacobi<n>()));
  }
  return points;
}

/// Calls visit(element, points) for each facet, with the nodes of the element behind it and the points
/// of its side. Throws Error for a facet that is not the side of exactly one element.
template <Element... Es, class Visit>
void for_each_side(Mesh<Es...> const& mesh, std::vector<Facet<Mesh<Es...>::dim>> const& facets,
                   Visit const& visit) {
  std::map<std::array<Index, 4>, int> seen;
  for (auto const& facet : facets) seen[mesh::key_of(facet)] = 0;
  auto const look_at = [&]<Element E>(E) {
    std::vector<std::vector<SidePoint<E>>> points;
    for (std::size_t s = 0; s < E::cell::sides().size(); ++s)
      points.push_back(side_points<E>(static_cast<int>(s)));
    for (Connectivity<E> const& element : mesh.template elements<E>())
      for (std::size_t s = 0; s < points.size(); ++s) {
        auto const found = seen.find(mesh::key_of(mesh::side_of<E>(element, static_cast<int>(s))));
        if (found == seen.end()) continue;
        if (++found->second == 1) visit(E{}, element, points[s]);
      }
  };
  (look_at(Es{}), ...);
  for (auto const& [key, times] : seen)
    if (times != 1)
      throw Error(
          "loads: a facet with the nodes ", key[2], " and ", key[3],
          times == 0 ? " is not the side of any element of the mesh" : " lies between two elements",
          "; give facets of its boundary");
}

template <int Dim>
void add_share(Point<Dim>& sum, double share, auto const& force) {
  for (std::size_t k = 0; k < Dim; ++k) sum[k] += share * force[k];
}

}  // namespace detail

/// (nodes, dim), N: the loads of a force per volume at rest, N/m³.
template <Element... Es, class Load>
std::vector<Point<Mesh<Es...>::dim>> body_loads(Mesh<Es...> const& mesh, Load const& force) {
  std::vector<Point<Mesh<Es...>::dim>> loads(mesh.nodes.size());
  auto const add = [&]<Element E>(E) {
    using Q = Gauss<SimplexCell<typename E::cell> ? 2 * E::degree + 2 : E::degree + 2>;
    // For 64 points of 27 nodes clang++ takes more steps than it allows a constant.
    static auto const table = tabulate<E, Q, double>();
    for (Connectivity<E> const& element : mesh.template elements<E>()) {
      auto const rest = nodal(mesh, element);
      auto const x = Coefficients<E, double>::of(rest);
      for (int q = 0; q < table.count; ++q) {
        Point<E::dim> place{};
        for (int a = 0; a < E::nodes; ++a)
          for (int k = 0; k < E::dim; ++k)
            place[static_cast<std::size_t>(k)] += table.shape[q][a] * rest(a, k);
        Point<E::dim> const b = detail::load_at(force, place);
        double const volume = RestMap<E, double>::at(x, table, q).volume * table.weight[q];
        for (std::size_t a = 0; a < E::nodes; ++a)
          detail::add_share<E::dim>(loads[static_cast<std::size_t>(element[a])],
                                    volume * table.shape[q][a], b);
      }
    }
  };
  (add(Es{}), ...);
  return loads;
}

/// (nodes, dim), N: the loads of a force per area at rest, N/m², on facets of the boundary. Throws Error for a
/// facet that is not the side of exactly one element.
template <Element... Es, class Load>
std::vector<Point<Mesh<Es...>::dim>> traction_loads(
    Mesh<Es...> const& mesh, std::vector<Facet<Mesh<Es...>::dim>> const& facets,
    Load const& traction) {
  std::vector<Point<Mesh<Es...>::dim>> loads(mesh.nodes.size());
  detail::for_each_side(mesh, facets,
                        [&]<Element E>(E, Connectivity<E> const& element, auto const& points) {
                          auto const x = nodal(mesh, element);
                          for (auto const& point : points) {
                            Point<E::dim> const t = detail::load_at(traction, point.place(x));
                            double const area = norm(point.area(x));
                            for (std::size_t a = 0; a < E::nodes; ++a)
                              detail::add_share<E::dim>(loads[static_cast<std::size_t>(element[a])],
                                                        area * point.shape[static_cast<int>(a)], t);
                          }
                        });
  return loads;
}

/// (nodes, dim), N: the loads of a pressure, Pa, that pushes on facets of the boundary, against their normals at
/// rest; or at displacements u, if given: a pressure that follows the surface, at this moment. Throws Error
/// for a facet that is not the side of exactly one element, and for displacements of another mesh.
template <Element... Es, class Load>
std::vector<Point<Mesh<Es...>::dim>> pressure_loads(
    Mesh<Es...> const& mesh, std::vector<Facet<Mesh<Es...>::dim>> const& facets,
    Load const& pressure, std::vector<Point<Mesh<Es...>::dim>> const& u = {}) {
  std::vector<Point<Mesh<Es...>::dim>> loads(mesh.nodes.size());
  if (!u.empty() && u.size() != loads.size())
    throw Error("pressure_loads: got displacements of ", u.size(), " nodes, but the mesh has ",
                loads.size());
  detail::for_each_side(
      mesh, facets, [&]<Element E>(E, Connectivity<E> const& element, auto const& points) {
        auto const rest = nodal(mesh, element);
        auto x = rest;
        if (!u.empty())
          for (std::size_t a = 0; a < E::nodes; ++a)
            for (std::size_t k = 0; k < E::dim; ++k)
              x(static_cast<int>(a), static_cast<int>(k)) +=
                  u[static_cast<std::size_t>(element[a])][k];
        for (auto const& point : points) {
          double const p = detail::load_at(pressure, point.place(rest));
          auto const area = point.area(x);
          Point<E::dim> outwards;
          for (int k = 0; k < E::dim; ++k) outwards[static_cast<std::size_t>(k)] = area[k];
          for (std::size_t a = 0; a < E::nodes; ++a)
            detail::add_share<E::dim>(loads[static_cast<std::size_t>(element[a])],
                                      -p * point.shape[static_cast<int>(a)], outwards);
        }
      });
  return loads;
}

}  // namespace pliant
