#include <numbers>

#include <pliant/mesh/loads.hpp>

#include "support/elements.hpp"
#include "support/formulations.hpp"

namespace pliant::test::loads_test {

/// ∫ y² dV over the box of distorted_mesh, [−0.25, 0.75] × [0.5, 1.5] (× [0.125, 1.125]).
constexpr double mean_square_of_y = (1.5 * 1.5 * 1.5 - 0.5 * 0.5 * 0.5) / 3;

TEMPLATE_TEST_CASE("body loads have the total and the moment of their density", "[body]",
                   ALL_ELEMENTS) {
  constexpr std::size_t dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  auto const loads = body_loads(mesh, [](Point<dim> const& X) {
    Point<dim> b{};
    b[0] = X[1];
    b[1] = 2;
    return b;
  });
  // Centred at (1/4, 1): ∫ y dV = 1, and the moment about z is ∫ (2 x − y²) dV.
  CHECK(total(loads)[0] == Approx(1).epsilon(1e-13));
  CHECK(total(loads)[1] == Approx(2).epsilon(1e-13));
  CHECK(moment(mesh.nodes, loads)[2] == Approx(0.5 - mean_square_of_y).epsilon(1e-13));
}

TEMPLATE_TEST_CASE("a constant body load is what consistent masses weigh", "[body]", ALL_ELEMENTS) {
  constexpr std::size_t dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  Point<dim> g{};
  g[1] = -10;
  auto const loads = body_loads(mesh, g);
  CHECK(total(loads)[1] == Approx(-10).epsilon(1e-13));
  CHECK(total(loads)[0] == 0);
  if constexpr (TestType::lumping == Lumping::row_sum) {
    auto const body =
        body_of<Formulation<TestType, Gauss<2>, Hooke>>(Reference<double>{}, mesh, {1, 0.3, 1});
    for (std::size_t i = 0; i < loads.size(); ++i)
      CHECK(loads[i][1] == Approx(-10 * body.parts().layout.mass_list()[i]).epsilon(1e-12));
  }
}

TEMPLATE_TEST_CASE("tractions have their total and moment on every side", "[body]", ALL_ELEMENTS) {
  constexpr std::size_t dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  auto const loads = traction_loads(mesh, mesh.boundary("right"), [](Point<dim> const& X) {
    Point<dim> t{};
    t[0] = 3 * X[1];
    return t;
  });
  CHECK(total(loads)[0] == Approx(3).epsilon(1e-13));
  CHECK(moment(mesh.nodes, loads)[2] == Approx(-3 * mean_square_of_y).epsilon(1e-13));
  auto const nodes = nodes_of(mesh.boundary("right"));
  for (Index i = 0; i < static_cast<Index>(loads.size()); ++i)
    if (!std::ranges::binary_search(nodes, i))
      CHECK(std::abs(loads[static_cast<std::size_t>(i)][0]) < 1e-16);
}

TEMPLATE_TEST_CASE("pressure pushes against each side, and not at all on the whole", "[body]",
                   ALL_ELEMENTS) {
  constexpr std::size_t dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  CHECK(total(pressure_loads(mesh, mesh.boundary("left"), 2.0))[0] == Approx(2).epsilon(1e-13));
  CHECK(total(pressure_loads(mesh, mesh.boundary("top"), 2.0))[dim - 1] ==
        Approx(-2).epsilon(1e-13));
  auto const all = pressure_loads(mesh, mesh::outer_sides(mesh), 1.0);
  for (double x : total(all)) CHECK(std::abs(x) < 1e-14);
  for (double x : moment(mesh.nodes, all)) CHECK(std::abs(x) < 1e-13);
}

TEMPLATE_TEST_CASE("a pressure that depends on depth lifts by the volume it displaces", "[body]",
                   ALL_ELEMENTS) {
  // Archimedes: −∮ p n dA = −∫ grad p dV, whatever the elements do inside.
  constexpr std::size_t dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  auto const loads = pressure_loads(mesh, mesh::outer_sides(mesh),
                                    [](Point<dim> const& X) { return 5 - 3 * X[1]; });
  CHECK(total(loads)[0] == Approx(0).margin(1e-13));
  CHECK(total(loads)[1] == Approx(3).epsilon(1e-13));
}

TEMPLATE_TEST_CASE("pressure that follows turns with the body and grows with its surface", "[body]",
                   ALL_ELEMENTS) {
  constexpr int dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  // A quarter turn of x into y, with a stretch by 2.
  auto h = Tensor<double, dim>::zero();
  h(0, 0) = h(1, 1) = -1;
  h(0, 1) = -2;
  h(1, 0) = 2;
  auto const loads = pressure_loads(mesh, mesh.boundary("left"), 1.0, uniform(mesh.nodes, h));
  CHECK(total(loads)[0] == Approx(0).margin(1e-13));
  CHECK(total(loads)[1] == Approx(2).epsilon(1e-13));
}

/// A quarter of a ring between the radii 1 and 2, its sides on the circles as far as E can bend.
template <Element E>
Mesh<E> quarter_ring(int n) {
  auto mesh = mesh::rectangle<E>({.size = {1, 1}, .cells = {n, n}});
  for (auto& p : mesh.nodes) {
    double const r = 1 + p[0], angle = std::numbers::pi / 2 * p[1];
    p = {r * std::cos(angle), r * std::sin(angle)};
  }
  return mesh;
}

TEMPLATE_TEST_CASE("loads on curved sides converge to those on the circle", "[body]", Tri6, Quad8,
                   Quad9) {
  // Pressure 1 on a quarter circle of radius 2 is a force (−2, −2): exact, as the ends are. The length π
  // of the arc is met to fourth order; straight chords would miss it by 6e-3 and 1.6e-3.
  auto const error = [](int n) {
    auto const mesh = quarter_ring<TestType>(n);
    auto const push = total(pressure_loads(mesh, mesh.boundary("right"), 1.0));
    CHECK(push[0] == Approx(-2).epsilon(1e-13));
    CHECK(push[1] == Approx(-2).epsilon(1e-13));
    auto const pull = total(traction_loads(mesh, mesh.boundary("right"), Point<2>{1, 0}));
    return std::abs(pull[0] - std::numbers::pi);
  };
  double const coarse = error(4), fine = error(8);
  CHECK(coarse < 1e-4);
  CHECK(fine < coarse / 14);
}

TEMPLATE_TEST_CASE("loads on curved faces converge to those on the cylinder", "[body]", Tet10,
                   Hex20, Hex27) {
  auto const error = [](int n) {
    auto mesh = mesh::box<TestType>({.size = {1, 1, 1}, .cells = {1, n, 2}});
    for (auto& p : mesh.nodes) {
      double const r = 1 + p[0], angle = std::numbers::pi / 2 * p[1];
      p = {r * std::cos(angle), r * std::sin(angle), p[2]};
    }
    auto const push = total(pressure_loads(mesh, mesh.boundary("right"), 1.0));
    CHECK(push[0] == Approx(-2).epsilon(1e-12));
    CHECK(push[1] == Approx(-2).epsilon(1e-12));
    CHECK(push[2] == Approx(0).margin(1e-13));
    auto const pull = total(traction_loads(mesh, mesh.boundary("right"), Point<3>{0, 0, 1}));
    return std::abs(pull[2] - std::numbers::pi);
  };
  double const coarse = error(4), fine = error(8);
  CHECK(coarse < 1e-4);
  CHECK(fine < coarse / 14);
}

TEST_CASE("facets that are no boundary of the mesh take no loads", "[body]") {
  auto const mesh = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {2, 1}});
  CHECK_THROWS_WITH(pressure_loads(mesh, {{0, 5}}, 1.0), says("not the side of any element"));
  CHECK_THROWS_WITH(traction_loads(mesh, {{1, 4}}, Point<2>{1, 0}), says("between two elements"));
}

TEST_CASE("loads of all nodes are those of each", "[body]") {
  auto const mesh = distorted_mesh<Quad4>(4);
  auto const loads = Random(1).field<2>(mesh.nodes.size(), 1);
  auto at_once = body_of<Formulation<Quad4, Gauss<2>, Hooke>>(Reference<double>{}, mesh);
  auto one_by_one = body_of<Formulation<Quad4, Gauss<2>, Hooke>>(Reference<double>{}, mesh);

  at_once.set_loads(loads);
  for (std::size_t i = 0; i < loads.size(); ++i)
    one_by_one.set_load(static_cast<Index>(i), loads[i]);

  CHECK(nodal_loads(at_once) == nodal_loads(one_by_one));
  auto const u = Random(2).field<2>(mesh.nodes.size(), 0.01);
  at_once.set_displacements(u);
  one_by_one.set_displacements(u);
  CHECK(potential_energy(at_once) == potential_energy(one_by_one));
  CHECK(potential_energy(at_once) == Approx(-inner(loads, u)).epsilon(1e-13));
  CHECK_THROWS_WITH(at_once.set_loads({{0, 0}}), says("body.set_loads: got values for 1"));
  CHECK(nodal_loads(at_once) == loads);
}

}  // namespace pliant::test::loads_test
