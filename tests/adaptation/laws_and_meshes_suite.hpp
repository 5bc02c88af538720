#pragma once

#include <numeric>

#include "adaptation/criteria.hpp"

// One limit that pays for laws and for meshes.
namespace pliant::test::laws_and_meshes_suite {

using Cheap = Formulation<Quad4, Gauss<2>, Hooke>;
using Costly = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using CheapQuadratic = Formulation<Quad9, Gauss<3>, Hooke>;
using CostlyQuadratic = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;

template <class B>
auto body_on(B const& backend) {
  return Body{backend, mesh::rectangle({.size = {4, 1}, .cells = {16, 4}}), soft, Group<Cheap>{},
              Group<Costly>{}};
}
template <class B>
auto body_of_degrees(B const& backend) {
  auto const quads = mesh::rectangle({.size = {4, 1}, .cells = {16, 4}});
  Mesh<Quad4, Quad9> mesh{quads.nodes, {}};
  mesh.elements<Quad4>() = quads.template elements<Quad4>();
  return Body{backend,
              mesh,
              soft,
              Group<Cheap>{},
              Group<Costly>{},
              Group<CheapQuadratic>{},
              Group<CostlyQuadratic>{}};
}

/// Bent more and more towards one end, so that elements turn there, and with a bump near the other, which asks for a finer
/// mesh.
template <class TheBody>
void deform(TheBody& body, double size = 1) {
  auto u = body.mesh().nodes;
  for (auto& p : u) {
    double const turned = size * 0.006 * std::pow(p[0], 3),
                 apart = square(p[0] - 1) + square(p[1] - 0.5);
    double const x = size * 0.02 * std::exp(-apart / square(0.2)), y = p[1] - 0.5;
    // The line in the middle, to second order of the angle.
    double const along = -square(size * 0.006) * std::pow(p[0], 7) / 14,
                 across = size * 0.0015 * std::pow(p[0], 4);
    p = {x + along - y * std::sin(turned), across + y * (std::cos(turned) - 1)};
  }
  body.set_displacements(u);
}
template <class TheBody, class... Adapt>
void look(TheBody& body, double size, Adapt&... adapt) {
  for (int k = 0; k < 10; ++k) {
    deform(body, size);
    (adapt.now(body), ...);
  }
  deform(body, size);
}
template <class TheBody>
double error_of_laws(TheBody const& body) {
  double sum = 0;
  for (double value : evaluate<Quad4>(body, Discrepancy<Costly>{})) sum += value;
  return sum;
}
template <class TheBody>
double error_of(TheBody const& body) {
  return estimate(body, RecoveredStress{}) + error_of_laws(body);
}
template <class TheBody>
double evaluations(TheBody const& body) {
  return evaluations_per_step(body, within<Cheap, Costly>(RecoveredStress{}, {.error = 1}));
}
/// The middle of elements in a group, along the body: the mean.
template <class TheBody>
double mean_place(TheBody const& body, Tag group) {
  auto const& mesh = body.mesh();
  auto const groups = body.template groups_of<Quad4>();
  double sum = 0, count = 0;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    if (groups[e] != group) continue;
    sum += mesh.nodes[static_cast<std::size_t>(mesh.template elements<Quad4>()[e][0])][0];
    count += 1;
  }
  return sum / count;
}

TEST_CASE("an error pays for laws and for meshes where either is worth more", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend);
    deform(body);
    double const error = error_of(body) / 40;
    auto adapt = Adaptation{within<Cheap, Costly>(RecoveredStress{}, {.error = error})};
    look(body, 1, adapt);
    CHECK(error_of(body) < 1.2 * error);
    CHECK(error_of(body) > 0.3 * error);
    CHECK(mean_place(body, 1) > mean_place(body, 0) + 1);  // the law where elements turn
    CHECK(std::ranges::max(refinement_levels<Quad4>(body)) >= 2);

    // What a share of the error for each asks for costs no less, whatever the share.
    for (double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      auto other = body_on(backend);
      auto laws = Adaptation{within<Cheap, Costly>({.error = share * error})};
      auto mesh = Adaptation{within<Cheap>(RecoveredStress{}, {.error = (1 - share) * error})};
      look(other, 1, mesh, laws);
      CHECK(evaluations(body) < 1.05 * evaluations(other));
    }

    look(body, 0, adapt);
    CHECK(evaluations(body) == evaluations(body_on(backend)));
  });
}

TEST_CASE("a budget pays for laws and for meshes", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend);
    double const budget = 600;
    MeshWithinOptions const options{.evaluations_per_step = budget, .max_level = 4};
    auto adapt = Adaptation{within<Cheap, Costly>(RecoveredStress{}, options)};
    look(body, 1, adapt);
    CHECK(evaluations(body) > 0.85 * budget);
    CHECK(evaluations(body) < 1.1 * budget);

    // Spent on the mesh alone, under either law, it leaves more of the error.
    auto cheap = body_on(backend), costly = body_on(backend);
    auto refine = Adaptation{within<Cheap>(RecoveredStress{}, options)};
    look(cheap, 1, refine);
    auto fewer = options;
    std::vector<Index> all(64);
    std::iota(all.begin(), all.end(), 0);
    costly.template assign<Costly>(all);
    fewer.evaluations_per_step = budget * 64 / evaluations(costly);
    auto refine_costly = Adaptation{within<Costly>(RecoveredStress{}, fewer)};
    look(costly, 1, refine_costly);
    CHECK(error_of(body) < 0.8 * error_of(cheap));
    CHECK(error_of(body) < 0.95 * error_of(costly));
  });
}

TEST_CASE("of a mesh that may not change, an error and a budget pay for laws alone",
          "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend), other = body_on(backend);
    deform(body);
    double const of_mesh = estimate(body, RecoveredStress{}), error = error_of_laws(body) / 20;
    auto adapt = Adaptation{
        within<Cheap, Costly>(RecoveredStress{}, {.error = of_mesh + error, .max_level = 0})};
    auto laws = Adaptation{within<Cheap, Costly>({.error = error})};
    look(body, 1, adapt);
    look(other, 1, laws);
    auto const costly = [](auto const& of) {
      return std::ranges::count(of.template groups_of<Quad4>(), Tag{1});
    };
    CHECK(error_of(body) <= of_mesh + error);
    CHECK(costly(body) < 64);
    CHECK(costly(body) == costly(other));

    // Half of them under the costly law.
    std::vector<Index> half(32);
    std::iota(half.begin(), half.end(), 0);
    other.template assign<Costly>(half);
    std::vector<Index> rest(32);
    std::iota(rest.begin(), rest.end(), 32);
    other.template assign<Cheap>(rest);
    double const budget = evaluations(other);
    auto paid = body_on(backend);
    deform(paid);
    auto pay = Adaptation{within<Cheap, Costly>(
        RecoveredStress{}, {.evaluations_per_step = budget + 0.01, .max_level = 0})};
    pay.now(paid);
    CHECK(costly(paid) == 32);
    CHECK(error_of(paid) < error_of(other));
  });
}

TEST_CASE("laws, sizes and degrees share a budget", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_of_degrees(backend);
    double const budget = 900;
    auto const rule = within<Cheap, Costly, CheapQuadratic, CostlyQuadratic>(
        RecoveredStress{}, {.evaluations_per_step = budget, .max_level = 4});
    auto adapt = Adaptation{rule};
    look(body, 1, adapt);
    double const now = evaluations_per_step(body, rule);
    CHECK(now > 0.85 * budget);
    CHECK(now < 1.1 * budget);
    CHECK(!body.mesh().template elements<Quad9>().empty());
    auto const groups = body.template groups_of<Quad9>(), linear = body.template groups_of<Quad4>();
    CHECK(std::ranges::count(groups, Tag{1}) + std::ranges::count(linear, Tag{1}) > 0);
    CHECK(std::ranges::count(groups, Tag{0}) + std::ranges::count(linear, Tag{0}) > 0);
  });
}

TEST_CASE("a mesh that cannot be refined keeps its laws", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend);
    deform(body, 0.3);
    set_mesh_limits(body, {.nodes = 90});
    auto adapt =
        Adaptation{within<Cheap, Costly>(RecoveredStress{}, {.error = error_of(body) / 40})};
    CHECK_THROWS_AS(adapt.now(body), Error);
    CHECK(body.mesh().template elements<Quad4>().size() == 64);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), Tag{1}) == 0);
    set_mesh_limits(body, {});
    adapt.now(body);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), Tag{1}) > 0);
  });
}

TEST_CASE("elements that sleep cost nothing and stay", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend);
    deform(body, 0.3);
    auto const rule = within<Cheap, Costly>(RecoveredStress{}, {.error = error_of(body) / 40});
    auto rest = Adaptation{within<Cheap, Costly>(RecoveredStress{}, {.error = 1e3}),
                           sleep({.below = 1e9, .for_steps = 8})}
                    .every(4);
    CentralDifference step;
    step(body, 16, rest);
    REQUIRE(asleep(body).patches > 0);
    REQUIRE(asleep(body).patches == asleep(body).of_patches);
    CHECK(evaluations(body) == 0);
    auto adapt = Adaptation{rule};
    adapt.now(body);
    CHECK(body.mesh().template elements<Quad4>().size() == 64);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), Tag{1}) == 0);
    deform(body, 0.3);  // wakes it
    adapt.now(body);
    auto const count = body.mesh().template elements<Quad4>().size();
    CHECK(count > 64);
    CHECK(std::ranges::count(body.template groups_of<Quad4>(), Tag{1}) > 0);

    auto fall_asleep = Adaptation{sleep({.below = 1e9, .for_steps = 8})}.every(4);
    step(body, 16, fall_asleep);
    REQUIRE(asleep(body).patches == asleep(body).of_patches);
    auto merge = Adaptation{within<Cheap, Costly>(RecoveredStress{}, {.error = 1e3})};
    merge.now(body);
    CHECK(body.mesh().template elements<Quad4>().size() == count);
    deform(body, 0.3);
    merge.now(body);
    CHECK(body.mesh().template elements<Quad4>().size() < count);
  });
}

TEST_CASE("laws of a rule are listed from cheap to costly", "[adaptation]") {
  auto body = body_on(Reference<double>{});
  auto adapt = Adaptation{within<Costly, Cheap>(RecoveredStress{}, {.error = 1e-3})};
  CHECK_THROWS_WITH(adapt.now(body), says("cheap to costly"));
}

}  // namespace pliant::test::laws_and_meshes_suite
