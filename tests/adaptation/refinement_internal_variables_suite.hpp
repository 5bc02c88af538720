#pragma once

#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/viscosity.hpp>

#include "support/formulations.hpp"

namespace pliant::test::refinement_internal_variables_suite {

TEST_CASE("children have their parent's values, and its points' memory, and give them back",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const visit = [&]<class E>(E) {
      using Q = Gauss<2>;
      using Graded = Formulation<E, Q, PerElement<SaintVenantKirchhoff>::template law>;
      using Viscous = Formulation<E, Q, Prony<SaintVenantKirchhoff>::template law>;
      auto const mesh = distorted_mesh<E>(3);
      std::size_t const count = mesh.template elements<E>().size();
      Random random;
      std::vector<std::array<double, 2>> values(count);
      for (auto& v : values) v = {4 + random(), 2 + random()};
      Body body{backend, mesh, soft, Group<Graded>{.values = values},
                Group<Viscous>{typename Viscous::template law<double>{{3, 2}, {0.5}, {0.1}}}};
      std::vector<Index> every_other;
      for (std::size_t e = 0; e < count; e += 2) every_other.push_back(static_cast<Index>(e));
      body.template assign<Viscous>(every_other);
      body.clamp(boundary_nodes(mesh));
      // A linear field is exact on every mesh; it is kept for a while, so that branches relax in part.
      auto h = Tensor<double, E::dim>::zero();
      h(0, 0) = 0.1;
      h(0, 1) = 0.2;
      take_steps(body.parts(), 0.01, 1);
      body.set_displacements(uniform(body.mesh().nodes, h));
      commit_at(body.parts(), std::as_const(body.parts()).u());
      set_step_size(body.parts(), 0.05);
      auto const along = uniform(mesh.nodes, h);
      double const energy = strain_energy(body), work = inner(body.forces(), along);

      std::vector<Index> marked{1, 2, 5};
      refine(body, {marked});
      refine(body, {{0, static_cast<Index>(body.mesh().template elements<E>().size()) - 1}});

      CHECK(body.mesh().template elements<E>().size() > count + 9);
      auto const finer = uniform(body.mesh().nodes, h);
      CHECK(difference(body.displacements(), finer) < 1e-14);
      CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
      CHECK(inner(body.forces(), finer) == Approx(work).epsilon(1e-13));

      for (std::size_t before = 0; before != body.mesh().nodes.size();) {
        before = body.mesh().nodes.size();
        std::vector<Index> all(body.mesh().template elements<E>().size());
        for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
        coarsen(body, {all});
      }

      CHECK(body.mesh().nodes == mesh.nodes);
      CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
      CHECK(inner(body.forces(), along) == Approx(work).epsilon(1e-13));
    };
    SECTION("Tri3") { visit(Tri3{}); }
    SECTION("Quad4") { visit(Quad4{}); }
    SECTION("Tet4") { visit(Tet4{}); }
    SECTION("Hex8") { visit(Hex8{}); }
  });
}

}  // namespace pliant::test::refinement_internal_variables_suite
