#pragma once

#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/assembly.hpp"
#include "support/repeatable.hpp"

namespace pliant::test::hanging_nodes_suite {

/// Irregular, with hanging nodes two and more levels deep.
template <class B, class M>
auto refined_body(B const& backend, M const& mesh, unsigned seed = 3, int rounds = 3) {
  auto body = plane_body(backend, mesh);
  Random random(seed);
  for (int k = 0; k < rounds; ++k) refine(body, random_marks(body, random, 5));
  return body;
}

TEST_CASE("hanging nodes stay in the middle of their side while the body moves", "[adaptation]") {
  on_plane_meshes<AllBackends>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = refined_body(backend, mesh);
    auto const hanging = hanging_nodes(body.mesh());
    REQUIRE(hanging);
    REQUIRE(hanging->size() > 5);
    Random random(4);
    auto const n = static_cast<std::size_t>(body.nodes());
    body.clamp(body.state().prescribed->conditions.empty() ? std::vector<Index>{0, 1}
                                                           : std::vector<Index>{});

    body.set_displacements(random.field<2>(n, 0.01));
    body.set_velocities(random.field<2>(n, 0.5));

    double const epsilon = epsilon_of<decltype(body)>;
    CHECK(gap(*hanging, body.displacements()) <= 0.02 * epsilon);
    CHECK(gap(*hanging, body.velocities()) <= epsilon);
    CentralDifference step;
    for (int k = 0; k < 3; ++k) {
      step(body, 7);
      CHECK(gap(*hanging, body.displacements()) <= 0.1 * epsilon);
      CHECK(gap(*hanging, body.velocities()) <= 4 * epsilon);
    }
    CHECK(largest(body.displacements()) > 0.02);
    for (auto const& h : *hanging)
      CHECK(body.parts().layout.mass_list()[static_cast<std::size_t>(h.node)] == 0);
  });
}

TEST_CASE("hanging nodes hand their forces to others", "[adaptation]") {
  on_plane_meshes<AllBackends>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = refined_body(backend, mesh);
    auto const hanging = *hanging_nodes(body.mesh());
    Random random(4);
    body.set_displacements(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.01));
    auto const u = body.displacements();

    auto const f = body.forces();

    double const size = largest(f);
    double const rounding = 32 * epsilon_of<decltype(body)> * size;
    for (double x : total(f)) CHECK(std::abs(x) < rounding);
    double moment_sum = moment(plus(body.mesh().nodes, 1, u), f)[2];
    CHECK(std::abs(moment_sum) < 4 * rounding);  // neo-Hookean everywhere
    for (auto const& h : hanging)
      CHECK(difference(FieldOf<2>{f[static_cast<std::size_t>(h.node)]}, FieldOf<2>(1)) <= rounding);
    CHECK(size > 1e-3);
  });
}

TEST_CASE("steps hand forces on while nodes advance, as they are where they are asked for",
          "[adaptation]") {
  on_plane_meshes<AllBackends>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto const moving = [&] {
      auto body = refined_body(backend, mesh);
      REQUIRE_FALSE(body.parts().layout.interpolation.empty());
      Random random(4);
      body.set_velocities(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.5));
      return body;
    };
    auto together = moving(), one_by_one = moving();
    double const dt = 0.5 * stable_step(together);
    constexpr int steps = 21;  // a stretch and more

    take_steps(together.parts(), dt, steps);
    for (int k = 0; k < steps; ++k) {
      evaluate_forces(one_by_one.parts());
      take_steps(one_by_one.parts(), dt, 1);
    }

    double const rounding = between_runs(1e3 * epsilon_of<decltype(together)>);
    CHECK(largest(together.displacements()) > 1e-4);
    CHECK(difference(together.displacements(), one_by_one.displacements()) <=
          rounding * largest(together.displacements()));
    CHECK(difference(together.velocities(), one_by_one.velocities()) <=
          rounding * largest(together.velocities()));
    CHECK(difference(together.forces(), one_by_one.forces()) <=
          rounding * largest(together.forces()));
  });
}

TEST_CASE("forces are the slope of the energy with hanging nodes too", "[adaptation]") {
  on_plane_meshes<MainAlone>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = refined_body(backend, mesh);
    Random random(4);
    auto const n = static_cast<std::size_t>(body.nodes());
    // What is given for a hanging node does not count: it follows the others.
    auto const u = random.field<2>(n, 0.01), du = random.field<2>(n, 1);
    double const h = 1e-6;
    auto const energy_at = [&](double s) {
      body.set_displacements(plus(u, s, du));
      return strain_energy(body);
    };

    double const slope = (energy_at(h) - energy_at(-h)) / (2 * h);
    auto const f = forces_at(body, u);
    auto const df = tangent_product(body, u, du);
    auto const forward = forces_at(body, plus(u, h, du)), back = forces_at(body, plus(u, -h, du));

    // Central differences: h² of the third derivative, and rounding over h.
    CHECK(-inner(f, du) == Approx(slope).epsilon(1e-7));
    CHECK(difference(df, plus(plus(FieldOf<2>(n), 1 / (2 * h), forward), -1 / (2 * h), back)) <
          1e-6 * largest(df));
    CHECK(std::abs(slope) > 1e-2);
  });
}

TEST_CASE("the tangent is symmetric with hanging nodes too", "[adaptation]") {
  on_plane_meshes<MainAlone>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = refined_body(backend, mesh);
    Random random(4);
    auto const n = static_cast<std::size_t>(body.nodes());
    auto const u = random.field<2>(n, 0.01), a = random.field<2>(n, 1), b = random.field<2>(n, 1);

    auto const k_a = tangent_product(body, u, a), k_b = tangent_product(body, u, b);

    // |a·K b| is a sum of n terms that largely cancel; compare with their size.
    CHECK(std::abs(inner(a, k_b) - inner(b, k_a)) < 1e-14 * largest(k_a) * static_cast<double>(n));
    CHECK(difference(k_a, k_b) > 0.1 * largest(k_a));
  });
}

TEST_CASE("a patch with hanging nodes takes a uniform state", "[adaptation]") {
  on_plane_meshes<MainAlone>(4, []<class B, class M>(B const& backend, M const& mesh) {
    for (unsigned seed : {3u, 8u}) {
      auto body = refined_body(backend, mesh, seed);
      REQUIRE(hanging_nodes(body.mesh())->size() > 5);
      auto const& nodes = body.mesh().nodes;
      auto const exact = uniform(nodes, Tensor<double, 2>{{{0.11, -0.06}, {0.2, -0.07}}});
      auto const outer = boundary_nodes(body.mesh());
      auto start = Random(seed).field<2>(nodes.size(), 0.003);
      for (Index i : outer) start[static_cast<std::size_t>(i)] = exact[static_cast<std::size_t>(i)];
      // The inner nodes start near the state: the law must not see inverted elements.
      for (std::size_t i = 0; i < start.size(); ++i)
        if (!std::ranges::binary_search(outer, static_cast<Index>(i)))
          for (std::size_t k = 0; k < 2; ++k) start[i][k] += exact[i][k];
      body.set_displacements(start);
      body.clamp(outer);

      solve_static(body);

      CHECK(difference(body.displacements(), exact) < 1e-12);
      auto const f = body.forces();
      for (std::size_t i = 0; i < f.size(); ++i)
        if (!std::ranges::binary_search(outer, static_cast<Index>(i)))
          CHECK(std::hypot(f[i][0], f[i][1]) < 1e-12 * largest(f));
    }
  });
}

TEST_CASE("the stable step is below the true limit with hanging nodes too", "[adaptation]") {
  on_plane_meshes<MainAlone>(3, []<class B, class M>(B const& backend, M const& mesh) {
    for (unsigned seed : {3u, 8u, 9u}) {
      auto body = refined_body(backend, mesh, seed, 2);
      REQUIRE_FALSE(hanging_nodes(body.mesh())->empty());
      for (double size : {0.0, 0.01}) {
        INFO("seed " << seed << ", displacements " << size);
        body.set_displacements(Random(seed).field<2>(static_cast<std::size_t>(body.nodes()), size));

        double const bound = stable_step(body);

        auto const squares =
            squared_frequencies(body, body.displacements(), [&](std::size_t node, std::size_t) {
              return body.parts().layout.mass_list()[node] > 0;
            });
        double const limit = 2 / std::sqrt(squares.maxCoeff());
        CHECK(bound <= limit);
        CHECK(bound > 0.4 * limit);
      }
    }
  });
}

}  // namespace pliant::test::hanging_nodes_suite
