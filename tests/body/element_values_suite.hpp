#pragma once

#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/guccione.hpp>
#include <pliant/solver/assemble.hpp>

#include "support/flat.hpp"
#include "support/formulations.hpp"

namespace pliant::test::element_values_suite {

TEST_CASE("a law whose parameters are those of each element is that law, element by element",
          "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using Graded = Formulation<Tet4, Gauss<1>, PerElement<NeoHookean>::law>;
    using Plain = Formulation<Tet4, Gauss<1>, NeoHookean>;
    auto const mesh = distorted_mesh<Tet4>(6);
    auto const u = Random(1).field<3>(mesh.nodes.size(), 0.01);
    std::size_t const count = mesh.elements<Tet4>().size();
    std::vector<std::array<double, 2>> values(count);
    for (std::size_t e = 0; e < count; ++e)
      values[e] = e % 2 ? std::array{3.0, 2.0} : std::array{7.0, 1.5};
    Body graded{backend, mesh, soft, Group<Graded>{.values = values}};
    auto const f = forces_at(graded, u);

    // The sum of two bodies, each of which has the elements of one kind.
    FieldOf<3> expected(u.size());
    double energy = 0;
    for (std::size_t kind : {0u, 1u}) {
      std::vector<Index> members;
      for (std::size_t e = kind; e < count; e += 2) members.push_back(static_cast<Index>(e));
      PartOfMesh<Tet4> const part(mesh, members);
      Body body{Reference<double>{}, part.mesh, soft,
                Group<Plain>{NeoHookean<double>{values[kind][0], values[kind][1]}}};
      expected = plus(expected, 1, part.put(forces_at(body, part.take(u)), u.size()));
      energy += strain_energy(body);
    }

    double const rounding = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(f, expected) < rounding * largest(expected));
    CHECK(strain_energy(graded) == Approx(energy).epsilon(rounding));
    // What is assembled for implicit solvers sees the same.
    Eigen::VectorXd x(static_cast<Eigen::Index>(3 * u.size()));
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) x[static_cast<Eigen::Index>(3 * i + k)] = u[i][k];
    CHECK(assemble(graded, x, Assemble::energy_and_force).energy == Approx(energy).epsilon(1e-13));
  });
}

TEST_CASE("a fibre stiffens along itself", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    using F = Formulation<Hex8, Gauss<2>, Guccione>;
    auto const mesh = distorted_mesh<Hex8>(4);
    Guccione<double> const muscle{.c = 2, .fibre = 8, .transverse = 2, .shearing = 4, .bulk = 0};
    auto h = Tensor<double, 3>::zero();
    h(0, 0) = 0.2;
    auto const u = uniform(mesh.nodes, h);
    auto const energy_along = [&](std::array<double, 3> const& fibre) {
      Body body{backend, mesh, soft, Group<F>{muscle, {fibre}}};
      body.set_displacements(u);
      return strain_energy(body);
    };
    // REFERENCES, section 6: stretched by 1.2 along and across, with E11 = 0.22.
    double const rounding = 1e-5;
    CHECK(energy_along({1, 0, 0}) == Approx(0.472851032024).epsilon(rounding));
    CHECK(energy_along({0, 3, 0}) == Approx(std::expm1(2 * 0.22 * 0.22)).epsilon(rounding));
  });
}

TEST_CASE("values per element that are missing or not finite are refused", "[body][errors]") {
  using F = Formulation<Tri3, Gauss<1>, PerElement<NeoHookean>::law>;
  MainBackend const backend;
  auto const mesh = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {2, 1}});
  auto const with = [&](std::vector<std::array<double, 2>> values) {
    Body body{backend, mesh, soft, Group<F>{.values = std::move(values)}};
  };
  CHECK_NOTHROW(with({{3, 2}}));
  CHECK_NOTHROW(with({{3, 2}, {3, 2}, {3, 2}, {3, 2}}));
  CHECK_THROWS_WITH(with({}), says("give values for 1 or for all 4 Tri3 elements, not for 0"));
  CHECK_THROWS_WITH(with({{3, 2}, {3, 2}}), says("not for 2"));
  CHECK_THROWS_WITH(with({{3, 2}, {3, 2}, {3, NAN}, {3, 2}}), says("value 1 of Tri3 element 2"));
}

}  // namespace pliant::test::element_values_suite
