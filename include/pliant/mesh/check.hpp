#pragma once

#include <cmath>
#include <string>

#include <pliant/formulation/kinematics.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/quadrature/corners.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant {

namespace detail {

template <Element E, class M>
std::string describe(M const& mesh, std::size_t e) {
  std::string text = message({E::name(), " element ", e, " with nodes"});
  for (Index node : mesh.template elements<E>()[e]) text += message({" ", node});
  return text;
}

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
    auto const check = [&]<class Q>(Q) {
      constexpr auto table = tabulate<E, Q, double>();
      for (int q = 0; q < table.count; ++q) {
        double const det =
            RestMap<E, double>::at(Coefficients<E, double>::of(rest), table, q).volume;
        if (!(det > smallest))
          throw Error("mesh: ", describe<E>(mesh, e), " is ",
                      det < -smallest ? "inverted" : "degenerate", " (Jacobian determinant ", det,
                      " near ", mesh.nodes[static_cast<std::size_t>(elements[e][0])],
                      "); number its nodes counter-clockwise, or repair the mesh there");
      }
    };
    if constexpr (LinearSimplex<E>)  // the same everywhere
      check(Gauss<1>{});
    else
      check(Gauss<E::degree + 1>{});
    if constexpr (!LinearSimplex<E> && QuadratureOn<Corners, typename E::cell>) check(Corners{});
  }
}

}  // namespace detail

/// Throws Error when the mesh has no elements, a node that is not finite, an index out of range, or
/// an element that is inverted or has no volume; the message names the first culprit.
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
}

}  // namespace pliant
