#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::other_elements_suite {

/// Calls visit(F{}) for elements beyond those of plane refinement.
template <class Visit>
void on_other_elements(Visit const& visit) {
  SECTION("Tri6") { visit(Formulation<Tri6, Gauss<2>, Hooke>{}); }
  SECTION("Quad8") { visit(Formulation<Quad8, Gauss<3>, Hooke>{}); }
  SECTION("Tet10") { visit(Formulation<Tet10, Gauss<2>, Hooke>{}); }
  SECTION("Hex20") { visit(Formulation<Hex20, Gauss<3>, Hooke>{}); }
  SECTION("Wedge6") { visit(Formulation<Wedge6, Gauss<2>, Hooke>{}); }
  SECTION("Pyramid5") { visit(Formulation<Pyramid5, Gauss<2>, Hooke>{}); }
}

TEST_CASE("criteria of uniform states do not depend on the element", "[adaptation]") {
  on_other_elements([]<class F>(F) {
    using E = typename F::element;
    auto const mesh = distorted_mesh<E>(3);
    auto const h = Random(3).tensor<F::dim>(0.3);
    auto f = h;
    for (int i = 0; i < F::dim; ++i) f(i, i) += 1;
    Body body{MainBackend{}, mesh, soft, Group<F>{}};
    body.set_displacements(uniform(mesh.nodes, h));
    for (double r : evaluate<E>(body, AreaRatio{}))
      CHECK(r == Approx(std::abs(determinant(f) - 1)).epsilon(1e-11));
    // An edge is stretched by what its direction is.
    double const most = evaluate<E>(body, EdgeLengthRatio{})[0];
    double seen = 0;
    auto const& element = mesh.template elements<E>()[0];
    for (auto const& [a, b] : E::edges()) {
      Vector<double, F::dim> edge;
      for (int k = 0; k < F::dim; ++k)
        edge[k] = mesh.nodes[std::size_t(element[std::size_t(b)])][std::size_t(k)] -
                  mesh.nodes[std::size_t(element[std::size_t(a)])][std::size_t(k)];
      seen = std::max(seen, std::abs(norm(f * edge) / norm(edge) - 1));
    }
    CHECK(most == Approx(seen).epsilon(1e-11));
  });
}

TEST_CASE("the aspect ratio of other solids is that of their edges", "[adaptation]") {
  MainBackend const backend;
  auto const box = [](auto element, std::array<int, 3> const& cells) {
    return mesh::box<decltype(element)>({.size = {3, 2, 1}, .cells = cells});
  };
  using W = Formulation<Wedge6, Gauss<2>, Hooke>;
  Body wedges{backend, box(Wedge6{}, {1, 1, 1}), soft, Group<W>{}};
  for (double a : evaluate<Wedge6>(wedges, AspectRatio{})) CHECK(a == Approx(std::sqrt(13.0)));
  using H = Formulation<Hex20, Gauss<3>, Hooke>;
  Body bricks{backend, box(Hex20{}, {1, 1, 1}), soft, Group<H>{}};
  CHECK(evaluate<Hex20>(bricks, AspectRatio{})[0] == Approx(3));
}

}  // namespace pliant::test::other_elements_suite
