#pragma once

#include <pliant/mesh/joined.hpp>

#include "support/formulations.hpp"

// Many bodies as one.
namespace pliant::test::joined_bodies_suite {

using Stiff = Formulation<Tet4, Gauss<1>, NeoHookean>;
using Soft = Formulation<Tet4, Gauss<1>, Hooke>;

inline std::vector<Mesh<Tet4>> bars(int count, std::array<int, 3> cells,
                                    Point<3> const& apart = {0, 0.75, 0}) {
  std::vector<Mesh<Tet4>> parts;
  for (int p = 0; p < count; ++p)
    parts.push_back(mesh::moved(mesh::box<Tet4>({.size = {2, 0.5, 0.5}, .cells = cells}),
                                {p * apart[0], p * apart[1], p * apart[2]}));
  return parts;
}
/// Part p turns and stretches at its own speed; part 0 rests.
inline std::vector<Point<3>> velocities(Mesh<Tet4> const& mesh, int part) {
  std::vector<Point<3>> v;
  for (auto const& x : mesh.nodes)
    v.push_back({0.3 * part * x[2], 0.1 * part * (x[0] - 1), -0.3 * part * x[0]});
  return v;
}

TEST_CASE("joined bodies move as each does by itself", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const parts = bars(3, {6, 2, 2});
    auto const all = mesh::joined(parts);
    Body body{backend, all.mesh, soft, Group<Stiff>{}, Group<Soft>{}};
    CentralDifference step{{.step = 2e-4}};
    Adaptation adapt{when<Stiff>(StrainNorm{}).below(0.02).become<Soft>(),
                     when<Soft>(StrainNorm{}).above(0.02).become<Stiff>()};
    std::vector<Point<3>> v;
    for (int p = 0; p < 3; ++p) {
      auto const own = velocities(parts[static_cast<std::size_t>(p)], p);
      v.insert(v.end(), own.begin(), own.end());
    }
    body.clamp(all.boundary(1, "left"));
    body.set_velocities(v);
    step(body, 160, adapt);
    auto const u = body.displacements();
    for (int p = 0; p < 3; ++p) {
      auto const k = static_cast<std::size_t>(p);
      Body alone{backend, parts[k], soft, Group<Stiff>{}, Group<Soft>{}};
      if (p == 1) alone.clamp(parts[k].boundary("left"));
      alone.set_velocities(velocities(parts[k], p));
      CentralDifference same{{.step = 2e-4}};
      same(alone, 160, adapt);
      auto const own = alone.displacements();
      double apart = 0;
      for (std::size_t i = 0; i < own.size(); ++i)
        for (std::size_t d = 0; d < 3; ++d)
          apart = std::max(
              apart, std::abs(own[i][d] - u[static_cast<std::size_t>(all.first_node[k]) + i][d]));
      INFO("part " << p);
      double const rounding = 4e3 * double{std::numeric_limits<typename B::scalar>::epsilon()};
      CHECK(apart <= rounding * largest(own));
      CHECK((largest(own) > 0) == (p > 0));
    }
  });
}

TEST_CASE("of joined bodies those sleep that rest", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const parts = bars(3, {80, 10, 10}, {3, 0, 0});
    auto const all = mesh::joined(parts);
    Body body{backend, all.mesh, soft, Group<Stiff>{}};
    std::vector<Point<3>> v(all.mesh.nodes.size());
    auto const own = velocities(parts[1], 1);
    std::ranges::copy(own, v.begin() + all.first_node[1]);
    body.set_velocities(v);
    CentralDifference step;
    Adaptation adapt{sleep({.below = 1e-4, .for_steps = 16})};
    step(body, 64, adapt);
    auto const asleep = asleep_elements<Tet4>(body);
    auto const sleeping = [&](std::size_t part) {
      Index count = 0;
      for (Index e = all.first_element[0][part]; e < all.first_element[0][part + 1]; ++e)
        count += asleep[static_cast<std::size_t>(e)];
      return static_cast<double>(count) / static_cast<double>(parts[part].elements<Tet4>().size());
    };
    CHECK(sleeping(0) > 0.5);  // patches may have elements of two parts
    CHECK(sleeping(1) == 0);
    CHECK(sleeping(2) > 0.5);
  });
}

}  // namespace pliant::test::joined_bodies_suite
