#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pliant/formulation/affine.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/check_middles.hpp>
#include <pliant/mesh/describe.hpp>
#include <pliant/mesh/sides.hpp>
#include <pliant/quadrature/corners.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant {

namespace detail {

template <Element E, class M>
void check_elements(M const& mesh) {
  auto const& elements = mesh.template elements<E>();
  auto const count = static_cast<Index>(mesh.nodes.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    Nodal<E, double> rest;
    double size = 0;
    for (int a = 0; a < E::nodes; ++a) {
      Index const node = elements[e][static_cast<std::size_t>(a)];
      if (node < 0 || node >= count)
        throw Error("mesh: ", describe<E>(mesh, e), " refers to node ", node,
                    ", but the mesh has nodes 0 to ", count - 1, "; correct the connectivity");
      for (int k = 0; k < E::dim; ++k) {
        rest(a, k) = mesh.nodes[static_cast<std::size_t>(node)][static_cast<std::size_t>(k)];
        size = std::max(size, std::abs(rest(a, k) - rest(0, k)));
      }
    }
    // Corners and quadrature points: where a map first folds, and where the forces look.
    double const smallest = 1e-12 * std::pow(size, E::dim);
    auto const check_volume = [&](double det) {
      if (!(det > smallest))
        throw Error("mesh: ", describe<E>(mesh, e), " is ",
                    det < -smallest ? "inverted" : "degenerate", " (Jacobian determinant ", det,
                    " near ", mesh.nodes[static_cast<std::size_t>(elements[e][0])],
                    "); number its nodes counter-clockwise, or repair the mesh there");
    };
    if (auto const gradient = affine_gradient<E>(rest)) {
      check_volume(determinant(*gradient));
      continue;
    }
    auto const coefficients = Coefficients<E, double>::of(rest);
    auto const check = [&]<class Q>(Q) {
      constexpr auto table = tabulate<E, Q, double>();
      for (int q = 0; q < table.count; ++q)
        check_volume(RestMap<E, double>::at(coefficients, table, q).volume);
    };
    check(Gauss<E::degree + 1>{});
    if constexpr (QuadratureOn<Corners, typename E::cell>) check(Corners{});
  }
}

/// Throws Error where two elements of a type have the same nodes.
template <Element E, class M>
void check_twins(M const& mesh) {
  auto const& elements = mesh.template elements<E>();
  std::vector<Index> smallest(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    smallest[e] = *std::min_element(elements[e].begin(), elements[e].end());
  auto const at_node = group_by_key(smallest, static_cast<Index>(mesh.nodes.size()));
  auto const sum = [&](Index e) {
    std::int64_t s = 0;
    for (Index node : elements[static_cast<std::size_t>(e)]) s += node;
    return s;
  };
  auto const sorted = [&](Index e) {
    auto nodes = elements[static_cast<std::size_t>(e)];
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  std::vector<std::int64_t> sums;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    auto const first = at_node.order.begin() + at_node.first[node];
    auto const last = at_node.order.begin() + at_node.first[node + 1];
    sums.clear();
    for (auto i = first; i != last; ++i) {
      sums.push_back(sum(*i));
      for (auto j = first; j != i; ++j)
        if (sums[static_cast<std::size_t>(j - first)] == sums.back() && sorted(*i) == sorted(*j))
          throw Error("mesh: ", describe<E>(mesh, static_cast<std::size_t>(*i)), " is element ", *j,
                      " again; leave one of them out");
    }
  }
}

/// Where a point lies on an edge, or on a side between two edges, that begin at one corner.
enum class Lies { elsewhere, on_first, on_second, between };

/// `x` and the ends of the edges are relative to the corner; plane meshes have only the first edge.
template <std::size_t Dim>
Lies where_on_side(std::array<double, Dim> const& x, std::array<double, Dim> const& first,
                   std::array<double, Dim> const& second, bool is_triangle) {
  auto const product = [](auto const& p, auto const& q) {
    double sum = 0;
    for (std::size_t k = 0; k < Dim; ++k) sum += p[k] * q[k];
    return sum;
  };
  double const a = product(first, first), c = product(second, second), xa = product(x, first);
  double s = xa / a, t = 0;
  if constexpr (Dim == 3) {
    double const b = product(first, second), xc = product(x, second), det = a * c - b * b;
    s = (xa * c - xc * b) / det;
    t = (xc * a - xa * b) / det;
  }
  constexpr double zero = 1e-6;
  double const most = is_triangle ? s + t : std::max(s, t);
  if (!(s > -zero && t > -zero && most < 1 - zero && std::max(s, t) > zero)) return Lies::elsewhere;
  if (t < zero) t = 0;
  if (s < zero) s = 0;
  double off = 0;
  for (std::size_t k = 0; k < Dim; ++k) {
    double const o = x[k] - s * first[k] - t * second[k];
    off += o * o;
  }
  if (!(off < 1e-18 * std::max(a, c))) return Lies::elsewhere;
  return t == 0 ? Lies::on_first : s == 0 ? Lies::on_second : Lies::between;
}

/// Throws Error where a node that is not listed as a slave lies inside an edge or a flat side of the boundary that
/// does not have it, beside a corner that they share: the mesh would come apart there.
template <class M>
void check_hanging(M const& mesh) {
  std::vector<bool> known(mesh.nodes.size(), false);
  for (auto const& slave : mesh.slaves) known[static_cast<std::size_t>(slave.node)] = true;
  auto const sides = mesh::outer_sides(mesh);
  std::vector<Index> corner, side_of_corner;
  for (std::size_t s = 0; s < sides.size(); ++s)
    for (std::size_t c = 0; c < sides[s].corners(); ++c) {
      corner.push_back(sides[s][c]);
      side_of_corner.push_back(static_cast<Index>(s));
    }
  auto const at_node = group_by_key(corner, static_cast<Index>(mesh.nodes.size()));
  auto const from = [&](Index origin, Index node) {
    auto x = mesh.nodes[static_cast<std::size_t>(node)];
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] -= mesh.nodes[static_cast<std::size_t>(origin)][k];
    return x;
  };
  for (auto const& side : sides)
    for (std::size_t c = 0, n = side.corners(); c < n; ++c) {
      Index const a = side[c], b = side[(c + 1) % n], d = side[(c + n - 1) % n];
      auto const i = static_cast<std::size_t>(a);
      auto const first = from(a, b), second = from(a, d);
      double reach = 0;
      for (double x : first) reach = std::max(reach, std::abs(x));
      for (Index k = at_node.first[i]; k < at_node.first[i + 1]; ++k) {
        auto const& other = sides[static_cast<std::size_t>(
            side_of_corner[static_cast<std::size_t>(at_node.order[static_cast<std::size_t>(k)])])];
        if (&other == &side) continue;
        for (Index node : other) {
          if (known[static_cast<std::size_t>(node)]) continue;
          if (std::find(side.begin(), side.end(), node) != side.end()) continue;
          // Where both sides have a node at one place, they are the lips of a slit.
          if (std::any_of(side.begin(), side.end(), [&](Index own) {
                auto const x = from(own, node);
                return std::ranges::all_of(
                    x, [&](double apart) { return std::abs(apart) <= 1e-9 * reach; });
              }))
            continue;
          auto const lies = where_on_side(from(a, node), first, second, n == 3);
          if (lies == Lies::elsewhere) continue;
          std::string on = message({"edge from node ", a, " to node "});
          on += message({lies == Lies::on_second ? d : b});
          if (lies == Lies::between)
            on = message({"side between the nodes ", b, ", ", a, " and ", d});
          throw Error("mesh: node ", node, " at ", mesh.nodes[static_cast<std::size_t>(node)],
                      " hangs on the ", on,
                      "; list it in mesh.slaves with its masters, or split the element beside it");
        }
      }
    }
}

/// Throws Error where slaves name nodes that there are not, with weights that are not positive or do not add up to
/// one, or that put the slave elsewhere: a rotation would strain the elements there.
template <class M>
void check_slaves(M const& mesh) {
  auto const count = static_cast<Index>(mesh.nodes.size());
  for (auto const& [node, masters] : mesh.slaves) {
    double sum = 0;
    bool good = node >= 0 && node < count && !masters.empty();
    for (auto const& [master, weight] : masters) {
      good = good && master >= 0 && master < count && master != node && weight > 0;
      sum += weight;
    }
    if (!good || !(std::abs(sum - 1) < 1e-9))
      throw Error("mesh: slave ", node,
                  " needs masters among the mesh's nodes, with positive weights that add up to 1");
    auto const& place = mesh.nodes[static_cast<std::size_t>(node)];
    Point<M::dim> off{};
    double reach = 0;
    for (auto const& [master, weight] : masters)
      for (std::size_t k = 0; k < M::dim; ++k) {
        double const apart = mesh.nodes[static_cast<std::size_t>(master)][k] - place[k];
        off[k] += weight * apart;
        reach = std::max(reach, std::abs(apart));
      }
    for (double x : off)
      if (!(std::abs(x) <= 1e-5 * reach))
        throw Error("mesh: slave ", node, " at ", place, " is ", off,
                    " away from where its masters and weights put it; correct one of them");
  }
}

}  // namespace detail

/// Throws Error when the mesh has no elements, a node that is not finite or belongs to no element, an index out
/// of range, an element that is inverted, has no volume or is there twice, or a node that hangs on an
/// edge or a flat side, or lies in the middle of one for one of its elements and not for another, and is not
/// listed as a slave; and for slaves whose weights do not add up to one or put them elsewhere. The message
/// names the first culprit.
template <Element... Es>
void check(Mesh<Es...> const& mesh) {
  if ((mesh.template elements<Es>().empty() && ...))
    throw Error("mesh: there are no elements; fill mesh.elements<E>() before making a body");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    for (double x : mesh.nodes[i])
      if (!std::isfinite(x))
        throw Error("mesh: node ", i, " at ", mesh.nodes[i],
                    " is not finite; correct its coordinates");
  (detail::check_elements<Es>(mesh), ...);
  std::vector<bool> used(mesh.nodes.size(), false);
  auto const use = [&](auto const& elements) {
    for (auto const& element : elements)
      for (Index node : element) used[static_cast<std::size_t>(node)] = true;
  };
  (use(mesh.template elements<Es>()), ...);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      throw Error("mesh: node ", i, " at ", mesh.nodes[i],
                  " belongs to no element; leave it out, and number the others without it");
  (detail::check_twins<Es>(mesh), ...);
  detail::check_slaves(mesh);
  detail::check_middles(mesh);
  detail::check_hanging(mesh);
}

}  // namespace pliant
