#pragma once

#include <cmath>

#include <pliant/mesh/loads.hpp>
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#include <pliant/solver/newton.hpp>

#include "verification/support/compositions.hpp"
#include "verification/support/table.hpp"

namespace pliant::verification {

/// The node nearest to a place.
template <class M>
std::size_t node_at(M const& mesh, Point<M::dim> const& place) {
  std::size_t nearest = 0;
  double least = INFINITY;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    double distance = 0;
    for (std::size_t k = 0; k < M::dim; ++k) distance += square(mesh.nodes[i][k] - place[k]);
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  if (least > 1e-18) throw Error("verification: there is no node at the place of interest");
  return nearest;
}

template <class F>
using LawOf = typename F::template law<double>;

/// A body of one formulation. Of a material, the law takes the moduli.
template <class F, class M>
auto body_of(M const& mesh, LawOf<F> const& law, double density = 1) {
  return Body{Reference<double>{}, mesh, Elastic{1, 0, density}, Group<F>{law}};
}
template <class F, class M>
auto body_of(M const& mesh, Elastic const& material) {
  return body_of<F>(mesh, LawOf<F>::from(material), material.density);
}

/// For elements much smaller than their body: their large forces cancel, and leave fewer digits.
inline constexpr NewtonOptions where_forces_cancel{.tolerance = 1e-7};
/// For corners where the exact solution folds or is about to, with elements graded towards them: the smallest fold
/// between the points of their rules, far from the places of interest.
inline constexpr NewtonOptions where_corners_fold{.tolerance = 1e-7, .accept_folded = true};

template <class M>
void add(std::vector<M>& sum, std::vector<M> const& more) {
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (std::size_t k = 0; k < sum[i].size(); ++k) sum[i][k] += more[i][k];
}

}  // namespace pliant::verification
