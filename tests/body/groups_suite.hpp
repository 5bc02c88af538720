#pragma once

#include "support/formulations.hpp"

namespace pliant::test::groups_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<3>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<3>, NeoHookean>;

/// The forces of some elements alone, from a body that has no others.
template <class F, class B, class M>
FieldOf<2> forces_of(B const& backend, M const& mesh, std::vector<Index> const& members,
                     FieldOf<2> const& u) {
  if (members.empty()) return FieldOf<2>(u.size());
  PartOfMesh<typename F::element> const part(mesh, members);
  auto body = body_of<F>(backend, part.mesh);
  return part.put(forces_at(body, part.take(u)), u.size());
}

TEST_CASE("each element has the forces of its group", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    Body body{backend, mesh, soft, Group<Linear>{}, Group<Turning>{}, Group<Rubber>{}};
    Random random(4);
    std::vector<Index> members[3];
    for (Index e = 0; e < static_cast<Index>(mesh.elements<Quad4>().size()); ++e)
      members[random.below(3)].push_back(e);
    auto const u = random.field<2>(mesh.nodes.size(), 0.02);

    body.template assign<Turning>(members[1]);
    body.template assign<Rubber>(members[2]);
    auto const f = forces_at(body, u);

    auto expected = forces_of<Linear>(backend, mesh, members[0], u);
    expected = plus(expected, 1, forces_of<Turning>(backend, mesh, members[1], u));
    expected = plus(expected, 1, forces_of<Rubber>(backend, mesh, members[2], u));
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(f, expected) < 16 * epsilon * largest(expected));
    auto const tags = body.template groups_of<Quad4>();
    for (std::size_t g = 0; g < 3; ++g)
      for (Index e : members[g]) CHECK(tags[static_cast<std::size_t>(e)] == g);
  });
}

TEST_CASE("elements can come back to their group", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    Body body{backend, mesh, soft, Group<Linear>{}, Group<Rubber>{}};
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const before = forces_at(body, u);

    body.template assign<Rubber>({3, 7, 11});
    auto const between = body.forces();
    body.template assign<Linear>({11, 3, 7});

    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(body.forces(), before) <= 16 * epsilon * largest(before));
    CHECK(difference(between, before) > 1e-3 * largest(before));
  });
}

TEST_CASE("a body joins elements of two types at their common nodes", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = mixed_mesh(8);
    using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;
    Body body{backend, mesh, soft, Group<Rubber>{}, Group<Triangles>{}, Group<Linear>{}};
    std::vector<Index> quads, triangles, all_quads;
    for (Index e = 0; e < static_cast<Index>(mesh.elements<Quad4>().size()); ++e)
      (e % 3 == 0 ? quads : all_quads).push_back(e);
    for (Index e = 0; e < static_cast<Index>(mesh.elements<Tri3>().size()); ++e)
      triangles.push_back(e);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);

    body.template assign<Linear>(quads);
    auto const f = forces_at(body, u);

    auto expected = forces_of<Triangles>(backend, mesh, triangles, u);
    expected = plus(expected, 1, forces_of<Linear>(backend, mesh, quads, u));
    expected = plus(expected, 1, forces_of<Rubber>(backend, mesh, all_quads, u));
    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(f, expected) < 16 * epsilon * largest(expected));
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-14));
  });
}

TEST_CASE("a group keeps the law it was given", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    Body stiff{backend, mesh, soft, Group<Linear>{Hooke<double>{30, 20}}};
    auto plain = body_of<Linear>(backend, mesh);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);

    auto const f = forces_at(stiff, u), tenth = forces_at(plain, u);

    double const epsilon = double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(f, plus(FieldOf<2>(u.size()), 10, tenth)) < 64 * epsilon * largest(f));
  });
}

}  // namespace pliant::test::groups_suite
