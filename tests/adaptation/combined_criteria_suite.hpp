#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test {

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

    double const rounding = 16 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    int each[3]{};
    for (std::size_t e = 0; e < a.size(); ++e) {
      CHECK(greatest[e] == Approx(std::max({a[e], b[e], c[e]})).epsilon(rounding));
      CHECK(least[e] == Approx(std::min({a[e], b[e], c[e]})).epsilon(rounding));
      CHECK(alone[e] == Approx(b[e]).epsilon(rounding));
      CHECK(nested[e] == Approx(std::max(std::min(a[e], b[e]), c[e])).epsilon(rounding));
      ++each[a[e] > b[e] && a[e] > c[e] ? 0 : b[e] > c[e] ? 1 : 2];
    }
    for (int times : each) CHECK((E::dim == 3 || times > 0));
  });
}

}  // namespace pliant::test
