#include <algorithm>
#include <random>

#include <pliant/solve.hpp>

#include "support/flat.hpp"
#include "support/formulations.hpp"

// Tetrahedra in fans around edges, as the OpenMP backend goes through them.
namespace pliant::test::fans_test {

using Kirchhoff = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
using Rubber = Formulation<Tet4, Gauss<1>, NeoHookean>;
using Connectivity = std::vector<std::array<Index, 4>>;

/// More than one patch, the last one not full.
Mesh<Tet4> block() { return distorted_mesh<Tet4>(12); }

/// Elements at random places of the mesh: hardly any has a neighbour in its patch.
Connectivity shuffled(Connectivity elements) {
  std::shuffle(elements.begin(), elements.end(), std::mt19937(1));
  return elements;
}

/// Whether two orders of four nodes differ by an even permutation.
bool have_one_orientation(std::array<Index, 4> const& a, std::array<Index, 4> b) {
  bool even = true;
  for (std::size_t i = 0; i < 4; ++i) {
    auto const at = std::find(b.begin() + static_cast<std::ptrdiff_t>(i), b.end(), a[i]);
    if (at == b.end()) return false;
    if (at != b.begin() + static_cast<std::ptrdiff_t>(i)) even = !even;
    std::iter_swap(b.begin() + static_cast<std::ptrdiff_t>(i), at);
  }
  return even;
}

TEST_CASE("fans have each tetrahedron once, by its nodes in its orientation", "[openmp]") {
  auto const mesh = block();
  for (auto const& elements : {mesh.elements<Tet4>(), shuffled(mesh.elements<Tet4>())}) {
    auto const count = static_cast<Index>(elements.size());
    REQUIRE(count > 2 * 2048);
    detail::Patches<4> const table(elements, 1, std::vector<Tag>(elements.size(), 0),
                                   static_cast<Index>(mesh.nodes.size()), NodeOrder::any_even);
    std::vector<int> times(elements.size());
    bool oriented = true;
    for (Index p = 0; p < table.patch_count(); ++p)
      table.fans(p).for_each_element([&](Index e, std::array<std::uint16_t, 4> const& corners) {
        CHECK(e / 2048 == p);
        ++times[static_cast<std::size_t>(e)];
        std::array<Index, 4> nodes;
        for (std::size_t a = 0; a < 4; ++a) nodes[a] = table.fans(p).nodes[corners[a]];
        oriented = oriented && have_one_orientation(elements[static_cast<std::size_t>(e)], nodes);
      });
    CHECK(oriented);
    CHECK(times == std::vector<int>(elements.size(), 1));
  }
}

TEST_CASE("six tetrahedra of a cube make a fan", "[openmp]") {
  Numbering<Tet4> const numbering(mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {6, 6, 6}}));
  auto const& elements = std::get<0>(numbering.tables);
  detail::HostFanSplitter splitter;
  int fans = 0;
  splitter.split(elements[0].data(), static_cast<int>(elements.size()),
                 [&](int const*, int const*, int const*, int) { ++fans; });
  CHECK(fans == 216);
}

TEST_CASE("elements that have a node twice, or an edge of many, are split into fans", "[openmp]") {
  Connectivity elements{{0, 0, 1, 2}, {0, 1, 2, 3}, {3, 3, 3, 3}};
  for (Index k = 0; k < 100; ++k) elements.push_back({0, 1, 10 + k, 11 + k});
  detail::HostFanSplitter splitter;
  std::vector<int> times(elements.size());
  splitter.split(elements[0].data(), static_cast<int>(elements.size()),
                 [&](int const*, int const*, int const* members, int size) {
                   CHECK(size <= detail::most_host_fan_elements);
                   for (int k = 0; k < size; ++k) ++times[static_cast<std::size_t>(members[k])];
                 });
  CHECK(times == std::vector<int>(elements.size(), 1));
}

/// Forces, tangent products and the stable step of a body in two groups.
template <class B>
auto computed(B const& backend, Mesh<Tet4> const& mesh, std::vector<Index> const& rubber) {
  Body body{backend, mesh, soft, Group<Kirchhoff>{}, Group<Rubber>{}};
  body.template assign<Rubber>(rubber);
  Random random(5);
  auto const u = random.field<3>(mesh.nodes.size(), 1e-3);
  auto const du = random.field<3>(mesh.nodes.size(), 1.0);
  return std::tuple{forces_at(body, u), tangent_product(body, u, du), stable_step(body)};
}

TEMPLATE_TEST_CASE("groups that cut fans have the forces that Reference gives", "[openmp]", float,
                   double) {
  double const rounding = sizeof(TestType) == 4 ? 1e-5 : 1e-13;
  auto const mesh = block();
  Random random(7);
  for (unsigned share : {1u, 3u, 50u}) {
    std::vector<Index> rubber;
    for (Index e = 0; e < static_cast<Index>(mesh.elements<Tet4>().size()); ++e)
      if (random.below(share) == 0) rubber.push_back(e);
    auto const [force, tangent, step] = computed(OpenMP<TestType>{{.threads = 2}}, mesh, rubber);
    auto const [known, known_tangent, known_step] = computed(Reference<double>{}, mesh, rubber);
    auto const same = [&](auto const& a, auto const& b) {
      double difference = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
          difference = std::max(difference, std::abs(a[i][k] - b[i][k]));
      CHECK(difference < rounding * largest(b));
    };
    same(force, known);
    same(tangent, known_tangent);
    CHECK(step == Approx(known_step).epsilon(1e-4));
  }
}

TEST_CASE("fans keep the bits for any number of threads", "[openmp]") {
  auto const mesh = block();
  std::vector<Index> rubber;
  for (Index e = 0; e < static_cast<Index>(mesh.elements<Tet4>().size()); e += 3)
    rubber.push_back(e);
  auto const one = computed(OpenMP<double>{{.threads = 1}}, mesh, rubber);
  for (int threads : {2, 3})
    CHECK(computed(OpenMP<double>{{.threads = threads}}, mesh, rubber) == one);
}

}  // namespace pliant::test::fans_test
