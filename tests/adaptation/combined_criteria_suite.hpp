#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::combined_criteria_suite {

TEST_CASE("largest and smallest combine criteria", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(4);
    auto const u = Random(4).field<E::dim>(mesh.nodes.size(), 0.02);
    auto const of = [&](auto const& criterion) {
      return values_at<E>(backend, mesh, u, criterion);
    };
    auto const a = of(EdgeLengthRatio{}), b = of(AreaRatio{}), c = of(Rotation{});

    auto const greatest = of(largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{})),
               least = of(smallest(EdgeLengthRatio{}, AreaRatio{}, Rotation{})),
               alone = of(largest(AreaRatio{})),
               nested = of(largest(smallest(EdgeLengthRatio{}, AreaRatio{}), Rotation{}));

    // A criterion is the distance of a ratio from 1, and rounded like that ratio however small it is.
    double const rounding = 16 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const rounded = [&](double value) { return Approx(value).epsilon(0).margin(rounding); };
    int each[3]{};
    for (std::size_t e = 0; e < a.size(); ++e) {
      CHECK(greatest[e] == rounded(std::max({a[e], b[e], c[e]})));
      CHECK(least[e] == rounded(std::min({a[e], b[e], c[e]})));
      CHECK(alone[e] == rounded(b[e]));
      CHECK(nested[e] == rounded(std::max(std::min(a[e], b[e]), c[e])));
      ++each[a[e] > b[e] && a[e] > c[e] ? 0 : b[e] > c[e] ? 1 : 2];
    }
    for (int times : each) CHECK((E::dim == 3 || times > 0));
  });
}

struct Missing {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    return not_a_number<typename State::scalar>();
  }
};

TEST_CASE("where a criterion is NaN, its combinations are, in whatever order", "[adaptation]") {
  on_each_element<FewBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(2);
    FieldOf<std::size_t{E::dim}> const u(mesh.nodes.size());
    auto const is_missing = [&](auto const& criterion) {
      return std::ranges::all_of(values_at<E>(backend, mesh, u, criterion),
                                 [](double value) { return std::isnan(value); });
    };

    CHECK(is_missing(largest(Missing{}, EdgeLengthRatio{})));
    CHECK(is_missing(largest(EdgeLengthRatio{}, Missing{})));
    CHECK(is_missing(smallest(Missing{}, EdgeLengthRatio{})));
    CHECK(is_missing(smallest(EdgeLengthRatio{}, Missing{}, AreaRatio{})));
    CHECK_FALSE(is_missing(largest(EdgeLengthRatio{}, AreaRatio{})));
  });
}

TEST_CASE("criteria of displacements that are NaN are NaN", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<E>(2);
    auto body = body_of<LinearOn<E>>(backend, mesh);
    auto const is_missing = [&](auto const& criterion) {
      return std::ranges::all_of(evaluate<E>(body, criterion),
                                 [](double value) { return std::isnan(value); });
    };
    REQUIRE_FALSE(is_missing(EdgeLengthRatio{}));
    auto& u = body.parts().state.u;
    u.upload(std::vector<T>(u.size(), std::numeric_limits<T>::quiet_NaN()));

    CHECK(is_missing(EdgeLengthRatio{}));
    CHECK(is_missing(AreaRatio{}));
    CHECK(is_missing(Rotation{}));
    CHECK(is_missing(AspectRatio{}));
    CHECK(is_missing(HarmonicMeanEdge{}));
    CHECK(is_missing(HarmonicMeanShape{}));
    CHECK(is_missing(ForceIntensity<>{}));
  });
}

}  // namespace pliant::test::combined_criteria_suite
