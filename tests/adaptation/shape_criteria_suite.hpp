#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::shape_criteria_suite {

TEST_CASE("aspect ratios have Verdict's values", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    double const tolerance = 32 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const aspect = [&](auto element, auto const& nodes) {
      using E = decltype(element);
      auto const mesh = single<E>(nodes);
      return values_at<E>(backend, mesh, FieldOf<std::size_t{E::dim}>(nodes.size()),
                          AspectRatio{})[0];
    };
    auto const near = [&](double x) { return Approx(x).epsilon(tolerance); };
    double const root2 = std::sqrt(2.0), root3 = std::sqrt(3.0);
    using P2 = std::vector<Point<2>>;
    using P3 = std::vector<Point<3>>;

    CHECK(aspect(Tri3{}, P2{{0, 0}, {1, 0}, {0.5, root3 / 2}}) == near(1));
    // l_max √2, Σl 2 + √2, A 1/2
    CHECK(aspect(Tri3{}, P2{{0, 0}, {1, 0}, {0, 1}}) == near((1 + root2) / root3));
    // 5, 12, 4√3 · 6
    CHECK(aspect(Tri3{}, P2{{0, 0}, {4, 0}, {0, 3}}) == near(5 * 12 / (4 * root3 * 6)));
    CHECK(aspect(Quad4{}, P2{{0, 0}, {1, 0}, {1, 1}, {0, 1}}) == near(1));
    CHECK(aspect(Quad4{}, P2{{0, 0}, {2, 0}, {2, 1}, {0, 1}}) == near(1.5));
    // Sides 3, √2, 1, 1... of a trapezium: l_max 3, Σl 3 + √2 + 2 + 1, A 2.5
    CHECK(aspect(Quad4{}, P2{{0, 0}, {3, 0}, {2, 1}, {0, 1}}) ==
          near(3 * (3 + root2 + 2 + 1) / (4 * 2.5)));
    CHECK(aspect(Tet4{}, P3{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}) == near(1));
    // l_max √2, ΣA 3/2 + √3/2, V 1/6
    CHECK(aspect(Tet4{}, P3{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) ==
          near(root2 * (1.5 + root3 / 2) / std::sqrt(6.0)));
    P3 const brick{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0},
                   {0, 0, 3}, {1, 0, 3}, {1, 2, 3}, {0, 2, 3}};
    CHECK(aspect(Hex8{}, brick) == near(3));
    // Each of the twelve edges counts: a node moved outward along one of its edges' directions.
    P3 const cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (std::size_t node = 0; node < 8; ++node)
      for (std::size_t k = 0; k < 3; ++k) {
        P3 moved = cube;
        moved[node][k] += moved[node][k] > 0.5 ? 0.25 : -0.25;
        CHECK(aspect(Hex8{}, moved) == near(1.25));
      }
  });
}

TEST_CASE("harmonic means of edges have the printed values", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    double const tolerance = 32 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const near = [&](double x) { return Approx(x).epsilon(tolerance); };
    auto const check_one = [&](auto element, auto const& nodes, std::vector<double> const& edges) {
      using E = decltype(element);
      auto const mesh = single<E>(nodes);
      FieldOf<std::size_t{E::dim}> const rest(nodes.size());
      double sum = 0, inverses = 0;
      for (double l : edges) sum += l, inverses += 1 / l;
      auto const n = static_cast<double>(edges.size());
      CHECK(values_at<E>(backend, mesh, rest, HarmonicMeanEdge{})[0] == near(n / inverses));
      CHECK(values_at<E>(backend, mesh, rest, HarmonicMeanShape{})[0] ==
            near(n / inverses / (sum / n)));
    };
    check_one(Tri3{}, std::vector<Point<2>>{{0, 0}, {4, 0}, {0, 3}}, {3, 4, 5});
    check_one(Quad4{}, std::vector<Point<2>>{{0, 0}, {3, 0}, {2, 1}, {0, 1}},
              {3, std::sqrt(2.0), 2, 1});
    check_one(Tet4{}, std::vector<Point<3>>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
              {1, 2, 3, std::sqrt(5.0), std::sqrt(10.0), std::sqrt(13.0)});
    check_one(
        Hex8{},
        std::vector<Point<3>>{
            {0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 3}, {1, 0, 3}, {1, 2, 3}, {0, 2, 3}},
        {1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3});
  });
}

TEST_CASE("shapes are those of the present positions", "[adaptation]") {
  on_each_element<MainAlone>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(3);
    auto const u = Random(3).field<E::dim>(mesh.nodes.size(), 0.03);
    auto moved = mesh;
    moved.nodes = plus(mesh.nodes, 1, u);
    FieldOf<std::size_t{E::dim}> const rest(mesh.nodes.size());
    auto const check_one = [&](auto const& criterion) {
      auto const displaced = values_at<E>(backend, mesh, u, criterion),
                 there = values_at<E>(backend, moved, rest, criterion),
                 before = values_at<E>(backend, mesh, rest, criterion);
      for (std::size_t e = 0; e < there.size(); ++e) {
        CHECK(displaced[e] == Approx(there[e]).epsilon(1e-13));
        CHECK(std::abs(displaced[e] - before[e]) > 1e-6);
      }
    };
    check_one(AspectRatio{});
    check_one(HarmonicMeanEdge{});
    check_one(HarmonicMeanShape{});
  });
}

}  // namespace pliant::test::shape_criteria_suite
