#pragma once

#include <pliant/quadrature/corners.hpp>

#include "verification/support/statics.hpp"

namespace pliant::verification {

/// The stress at a corner node: that of the displacement gradient there, the mean over the elements around
/// it.
template <Element E, class L>
Tensor<double, E::dim> stress_at(Mesh<E> const& mesh, std::vector<Point<E::dim>> const& u,
                                 L const& law, std::size_t node) {
  static constexpr auto corners = tabulate<E, Corners, double>();
  auto sum = Tensor<double, E::dim>::zero();
  int count = 0;
  for (auto const& element : mesh.template elements<E>())
    for (int c = 0; c < E::cell::corners; ++c) {
      if (static_cast<std::size_t>(element[static_cast<std::size_t>(c)]) != node) continue;
      Nodal<E, double> own;
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < E::dim; ++k)
          own(a, k) = u[static_cast<std::size_t>(element[static_cast<std::size_t>(a)])]
                       [static_cast<std::size_t>(k)];
      auto const x = Coefficients<E, double>::of(nodal(mesh, element));
      auto const v = Coefficients<E, double>::of(own);
      sum = sum + stress(law, RestMap<E, double>::at(x, corners, c).gradient(v, corners, c));
      ++count;
    }
  return 1.0 / count * sum;
}

}  // namespace pliant::verification
