#pragma once

#include <functional>

#include "adaptation/estimates.hpp"
#include "adaptation/plane_bodies.hpp"
#include "support/fields.hpp"

namespace pliant::test::recovered_stress_suite {

static_assert(Estimator<RecoveredStress, QuadLinear>);
static_assert(!Estimator<Rotation, QuadLinear>);

TEST_CASE("uniform stress has no error with hanging nodes and several groups", "[estimator]") {
  on_plane_meshes<AllBackends>(4, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(3);
    for (int k = 0; k < 3; ++k) refine(body, random_marks(body, random, 5));
    put(body, random_marks(body, random, 2), Put::linear);
    REQUIRE(body.mesh().slaves.size() > 5);
    Tensor<double, 2> const h = random.tensor<2>(0.1);

    body.set_displacements(uniform(body.mesh().nodes, h));

    double const epsilon = epsilon_of<decltype(body)>;
    CHECK(estimate(body, RecoveredStress{}) < square(500 * epsilon) * strain_energy(body));
  });
}

TEST_CASE("a stress that jumps between groups has no error, and within one it has", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Left = Formulation<Quad4, Gauss<2>, Hooke>;
    using Right = Formulation<Quad4, Gauss<3>, Hooke>;
    auto const mesh = mesh::rectangle<Quad4>({.size = {2, 1}, .cells = {6, 3}});
    Body body{backend, mesh, soft, Group<Left>{}, Group<Right>{}};
    auto u = mesh.nodes;
    for (auto& p : u) p = {p[0] < 1 ? 0.01 * p[0] : 0.01 + 0.05 * (p[0] - 1), 0};
    body.set_displacements(u);

    double const within_one = estimate(body, RecoveredStress{});
    std::vector<Index> right;
    for (std::size_t e = 0; e < mesh.elements<Quad4>().size(); ++e)
      if (mesh.nodes[static_cast<std::size_t>(mesh.elements<Quad4>()[e][0])][0] > 0.99)
        right.push_back(static_cast<Index>(e));
    body.template assign<Right>(right);
    double const between = estimate(body, RecoveredStress{});

    CHECK(right.size() == 9);
    CHECK(within_one > 1e-2 * strain_energy(body));
    CHECK(between < 1e-25 * strain_energy(body));
  });
}

TEST_CASE("the estimate of a strain that jumps by one is in closed form", "[estimator]") {
  // Two elements of edge 1 with stresses 0 and 2 Pa: σ* − σ goes from 0 to 1 Pa, and E = 2 Pa.
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element E, class Q>(E, Q) {
      using F = Formulation<E, Q, Hooke>;
      Mesh<E> mesh;
      if constexpr (E::dim == 2)
        mesh = mesh::rectangle<E>({.size = {2, 1}, .cells = {2, 1}});
      else
        mesh = mesh::box<E>({.size = {2, 1, 1}, .cells = {2, 1, 1}});
      Body body{backend, mesh, soft, Group<F>{Hooke<double>{0, 1}}};
      auto u = mesh.nodes;
      for (auto& p : u) {
        double const x = p[0];
        p = {};
        p[0] = std::max(0.0, x - 1);
      }
      body.set_displacements(u);
      for (double value : evaluate<E>(body, RecoveredStress{}))
        CHECK(value == Approx(1.0 / 12).epsilon(1e-5));
    };
    check(Quad4{}, Gauss<2>{});
    check(Quad4{}, Gauss<3>{});
    check(Quad4{}, OnePoint{});
    check(Hex8{}, Gauss<2>{});
  });
}

TEST_CASE("one bilinear element alone is off its mean stress", "[estimator]") {
  // u = x y: σ11 = 2 y and σ12 = x, less their means.
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const check = [&]<class Q>(Q, double expected) {
      using F = Formulation<Quad4, Q, Hooke>;
      auto const mesh = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {1, 1}});
      Body body{backend, mesh, soft, Group<F>{Hooke<double>{0, 1}}};
      auto u = mesh.nodes;
      for (auto& p : u) p = {p[0] * p[1], 0};
      body.set_displacements(u);
      CHECK(estimate(body, RecoveredStress{}) == Approx(expected).epsilon(1e-5).margin(1e-12));
    };
    check(Gauss<2>{}, 1.0 / 8);
    check(Gauss<3>{}, 1.0 / 8);
    check(OnePoint{}, 0);
  });
}

TEST_CASE("quadratic elements see the part of the stress that is quadratic", "[estimator]") {
  // u = x³/6 and E = 2 Pa: σ = x², less what lies in the element at its superconvergent points.
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const check = [&]<Element E>(E) {
      using F = Formulation<E, Gauss<3>, Hooke>;
      auto const mesh = mesh::rectangle<E>({.size = {5, 1}, .cells = {5, 1}});
      Body body{backend, mesh, soft, Group<F>{Hooke<double>{0, 1}}};
      auto u = mesh.nodes;
      for (auto& p : u) p = {p[0] * p[0] * p[0] / 6, 0};
      body.set_displacements(u);
      double const exact = 0.5 / 2 * (4.0 / 45) / 16;  // ½/E ∫ ((ξ² − 1/3)/4)² dx
      CHECK(evaluate<E>(body, RecoveredStress{})[2] == Approx(exact).epsilon(1e-10));
    };
    check(Quad8{});
    check(Quad9{});
  });
}

TEST_CASE("estimates grow with the square of small displacements and with the moduli",
          "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri6, Gauss<2>, Hooke>;
    auto const mesh = distorted_mesh<Tri6>(3);
    auto const of = [&](double size, double factor) {
      Body body{backend, mesh, soft, Group<F>{Hooke<double>{3 * factor, 2 * factor}}};
      body.set_displacements(smooth_field(mesh.nodes, size));
      return evaluate<Tri6>(body, RecoveredStress{});
    };
    auto const one = of(0.01, 1), larger = of(0.03, 1), stiffer = of(0.01, 7);
    for (std::size_t e = 0; e < one.size(); ++e) {
      CHECK(larger[e] == Approx(9 * one[e]));
      CHECK(stiffer[e] == Approx(7 * one[e]));
    }
  });
}

TEST_CASE("rotation leaves estimates alone", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    on_formulations(List<Formulation<Quad4, Gauss<2>, NeoHookean>,
                         Formulation<Tri6, Gauss<2>, SaintVenantKirchhoff>,
                         Formulation<Tet4, Gauss<1>, NeoHookean>>{},
                    [&]<class F>(List<F>) {
                      CAPTURE(formulation_name<F>());
                      auto const mesh = distorted_mesh<typename F::element>(3);
                      auto const u = smooth_field(mesh.nodes, 0.03);
                      auto const r = turn<F::dim>(1.1, {1, 2, -1});
                      auto turned = u;
                      for (std::size_t i = 0; i < u.size(); ++i)
                        for (std::size_t k = 0; k < F::dim; ++k) {
                          turned[i][k] = -mesh.nodes[i][k];
                          for (std::size_t j = 0; j < F::dim; ++j)
                            turned[i][k] += r(static_cast<int>(k), static_cast<int>(j)) *
                                            (mesh.nodes[i][j] + u[i][j]);
                        }

                      auto const before = estimates<F>(backend, mesh, u),
                                 after = estimates<F>(backend, mesh, turned);

                      for (std::size_t e = 0; e < before.size(); ++e) {
                        CHECK(before[e] > 0);
                        CHECK(after[e] == Approx(before[e]).epsilon(1e-9));
                      }
                    });
  });
}

/// Stresses and means of Tri3 under Hooke's law, by another way: a loop over elements on the host.
template <class TheBody>
std::vector<double> estimates_by_hand(TheBody const& body, std::vector<Tag> const& groups) {
  double const mu = soft.lame_mu(), lambda = soft.lame_lambda();
  auto const& mesh = body.mesh();
  auto const u = body.displacements();
  auto const& elements = mesh.template elements<Tri3>();
  std::vector<std::array<double, 3>> stress(elements.size());
  std::vector<double> area(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    auto const at = [&](auto const& field, int a) {
      return field[static_cast<std::size_t>(elements[e][static_cast<std::size_t>(a)])];
    };
    auto const o = at(mesh.nodes, 0), p = at(mesh.nodes, 1), q = at(mesh.nodes, 2);
    double const a = p[0] - o[0], b = p[1] - o[1], c = q[0] - o[0], d = q[1] - o[1],
                 twice = a * d - b * c;
    double h[2][2];
    for (std::size_t i = 0; i < 2; ++i) {
      double const du = at(u, 1)[i] - at(u, 0)[i], dv = at(u, 2)[i] - at(u, 0)[i];
      h[i][0] = (du * d - dv * b) / twice;
      h[i][1] = (dv * a - du * c) / twice;
    }
    double const t = lambda * (h[0][0] + h[1][1]);
    stress[e] = {t + 2 * mu * h[0][0], t + 2 * mu * h[1][1], mu * (h[0][1] + h[1][0])};
    area[e] = twice / 2;
  }
  std::vector<double> estimates(elements.size());
  for (Tag group : {Tag{0}, Tag{1}}) {
    std::vector<std::array<double, 4>> sum(mesh.nodes.size());
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (groups[e] == group)
        for (Index node : elements[e])
          for (std::size_t k = 0; k < 4; ++k)
            sum[static_cast<std::size_t>(node)][k] += area[e] * (k < 3 ? stress[e][k] : 1);
    for (auto const& slave : mesh.slaves)
      for (auto const& [master, weight] : slave.masters)
        for (std::size_t k = 0; k < 4; ++k)
          sum[static_cast<std::size_t>(master)][k] +=
              weight * sum[static_cast<std::size_t>(slave.node)][k];
    for (auto& s : sum)
      for (std::size_t k = 0; k < 3; ++k) s[k] = s[3] > 0 ? s[k] / s[3] : 0;
    for (auto const& slave : mesh.slaves) {
      auto& own = sum[static_cast<std::size_t>(slave.node)];
      own = {};
      for (auto const& [master, weight] : slave.masters)
        for (std::size_t k = 0; k < 3; ++k)
          own[k] += weight * sum[static_cast<std::size_t>(master)][k];
    }
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (groups[e] != group) continue;
      for (std::size_t a = 0; a < 3; ++a) {  // the middles of edges integrate squares exactly
        auto const &p = sum[static_cast<std::size_t>(elements[e][a])],
                   &q = sum[static_cast<std::size_t>(elements[e][(a + 1) % 3])];
        std::array<double, 3> off;
        for (std::size_t k = 0; k < 3; ++k) off[k] = (p[k] + q[k]) / 2 - stress[e][k];
        double const trace = (off[0] + off[1]) / (2 * (lambda + mu)),
                     deviator = (off[0] - off[1]) / 2;
        estimates[e] +=
            area[e] / 3 *
            ((off[0] + off[1]) * trace / 4 + (deviator * deviator + off[2] * off[2]) / (2 * mu));
      }
    }
  }
  return estimates;
}

TEST_CASE("estimates with hanging nodes and groups are those of a loop over elements",
          "[estimator]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using Other = Formulation<Tri3, Gauss<2>, Hooke>;
    Body body{backend, distorted_mesh<Tri3>(4), soft, Group<TriLinear>{}, Group<Other>{}};
    Random random(3);
    for (int k = 0; k < 3; ++k) refine(body, random_marks(body, random, 5));
    body.template assign<Other>(random_marks(body, random, 2).front());
    REQUIRE(body.mesh().slaves.size() > 5);
    body.set_displacements(random.field<2>(static_cast<std::size_t>(body.nodes()), 0.01));

    auto const found = evaluate<Tri3>(body, RecoveredStress{});
    auto const expected = estimates_by_hand(body, body.template groups_of<Tri3>());

    double const tolerance = sizeof(typename B::scalar) == 4 ? 1e-3 : 1e-10;
    for (std::size_t e = 0; e < found.size(); ++e)
      CHECK(found[e] == Approx(expected[e]).epsilon(tolerance));
  });
}

TEST_CASE("an inverted element has no estimate and leaves its neighbours theirs", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, StableNeoHookean>;
    auto const mesh = regular_mesh<Tri3>(4);
    auto body = body_of<F>(backend, mesh);
    auto u = uniform(mesh.nodes, Random(4).tensor<2>(0.05));
    Index const node = mesh.elements<Tri3>()[7][1];
    u[static_cast<std::size_t>(node)][0] -= 0.4;
    body.set_displacements(u);
    auto const found = evaluate<Tri3>(body, RecoveredStress{});

    int inverted = 0;
    for (std::size_t e = 0; e < found.size(); ++e) {
      Tensor<double, 2> edges;
      for (int a = 0; a < 2; ++a)
        for (std::size_t k = 0; k < 2; ++k) {
          auto const& nodes = mesh.elements<Tri3>()[e];
          auto const n = static_cast<std::size_t>(nodes[static_cast<std::size_t>(a + 1)]),
                     m = static_cast<std::size_t>(nodes[0]);
          edges(a, static_cast<int>(k)) = mesh.nodes[n][k] + u[n][k] - mesh.nodes[m][k] - u[m][k];
        }
      bool const is_inverted = determinant(edges) < 0;
      inverted += is_inverted ? 1 : 0;
      CHECK(std::isnan(found[e]) == is_inverted);
    }
    CHECK(inverted > 0);
    double sum = 0;
    for (double x : found) sum += std::isnan(x) ? 0 : x;
    CHECK(estimate(body, RecoveredStress{}) == Approx(sum));
  });
}

TEST_CASE("rules act by estimates as by other criteria", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    Body body{backend, mesh, soft, Group<QuadLinear>{}, Group<QuadRubber>{}};
    body.set_displacements(smooth_field(mesh.nodes, 0.05));
    auto const value = evaluate<Quad4>(body, RecoveredStress{});
    double const limit = estimate(body, RecoveredStress{}) / static_cast<double>(value.size());

    SECTION("switching") {
      Adaptation{when<QuadLinear>(RecoveredStress{}).above(limit).template become<QuadRubber>(),
                 when<QuadRubber>(RecoveredStress{}).below(limit).template become<QuadLinear>()}
          .now(body);
      auto const groups = body.template groups_of<Quad4>();
      for (std::size_t e = 0; e < value.size(); ++e) CHECK(groups[e] == (value[e] > limit));
      CHECK(std::ranges::count(groups, 1) > 3);
    }
    SECTION("what they are made of") {
      Adaptation{when<QuadLinear>(2.0 * largest(RecoveredStress{}, 0.5 * RecoveredStress{}))
                     .above(2 * limit)
                     .template become<QuadRubber>()}
          .now(body);
      auto const groups = body.template groups_of<Quad4>();
      for (std::size_t e = 0; e < value.size(); ++e) CHECK(groups[e] == (value[e] > limit));
    }
    SECTION("refinement") {
      std::vector<Index> order(value.size());
      for (std::size_t e = 0; e < order.size(); ++e) order[e] = static_cast<Index>(e);
      std::ranges::sort(order, std::greater{},
                        [&](Index e) { return value[static_cast<std::size_t>(e)]; });
      std::vector<Index> marked;
      double left = 0.5 * estimate(body, RecoveredStress{});
      for (std::size_t k = 0; left > 0; ++k) {
        marked.push_back(order[k]);
        left -= value[static_cast<std::size_t>(order[k])];
      }
      Body other{backend, mesh, soft, Group<QuadLinear>{}, Group<QuadRubber>{}};
      refine(other, {marked});

      Adaptation{when<QuadLinear>(RecoveredStress{}).bulk(0.5).refine()}.now(body);

      CHECK(marked.size() > 2);
      CHECK(body.mesh().template elements<Quad4>() == other.mesh().template elements<Quad4>());
    }
  });
}

}  // namespace pliant::test::recovered_stress_suite
