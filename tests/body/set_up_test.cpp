#include "support/formulations.hpp"
#include "support/meshes.hpp"

// Meshes and bodies are the same, bit for bit, and so are errors, whatever the number of threads that make them.
namespace pliant::test::set_up_test {

template <Element E>
using Of = Formulation<E, Gauss<SimplexCell<typename E::cell> ? E::degree : E::degree + 1>, Hooke>;

/// What a function gives on one thread and on four.
template <class F>
auto on_threads(F const& f) {
  auto const run = [&](int most) {
    HostThreads const threads(most);
    return f();
  };
  return std::pair{run(1), run(4)};
}

template <Element E>
Mesh<E> regular() {
  return regular_mesh<E>(E::dim == 2 ? 150 : E::nodes == 4 ? 17 : E::nodes == 8 ? 25 : 15);
}

template <class M>
std::string complaint(M const& mesh) {
  try {
    check(mesh);
  } catch (Error const& error) {
    return error.what();
  }
  return {};
}

TEMPLATE_TEST_CASE("generated meshes do not depend on the number of threads", "[body]", Tri6, Tet4,
                   Tet10, Hex8, Hex27) {
  auto const [one, four] = on_threads([] { return regular<TestType>(); });
  REQUIRE(one.template elements<TestType>().size() >=
          2 * std::size_t(pliant::detail::few_elements(TestType::nodes)));
  CHECK(one.nodes == four.nodes);
  CHECK(one.tables == four.tables);
  CHECK(one.boundaries == four.boundaries);
}

TEMPLATE_TEST_CASE("bodies do not depend on the number of threads", "[body]", Tri6, Tet4, Tet10,
                   Hex8, Hex27) {
  auto const mesh = shuffled(regular<TestType>());
  auto const numbered = on_threads([&] { return Numbering<TestType>(mesh); });
  CHECK(numbered.first.internal_node == numbered.second.internal_node);
  CHECK(numbered.first.user_node == numbered.second.user_node);
  CHECK(numbered.first.tables == numbered.second.tables);
  CHECK(numbered.first.user_element == numbered.second.user_element);
  auto const outer = on_threads([&] { return mesh::outer_sides(mesh); });
  CHECK(outer.first == outer.second);
  auto const made = on_threads([&] {
    Body body{MainBackend{}, mesh, soft, Group<Of<TestType>>{}};
    auto u = mesh.nodes;
    for (auto& x : u) x[0] *= 0.01 * x[1];
    body.set_displacements(u);
    auto const& layout = body.parts().layout;
    return std::tuple{layout.mass_list(), layout.mass_in_all, download<double>(layout.mass),
                      download<double>(layout.rest), body.forces()};
  });
  CHECK((made.first == made.second));
}

TEMPLATE_TEST_CASE("changes of the mesh do not depend on the number of threads", "[body]", Quad4,
                   Tet4) {
  auto const changed = on_threads([] {
    Body body{MainBackend{}, regular_mesh<TestType>(TestType::dim == 2 ? 50 : 10), soft,
              Group<Of<TestType>>{}};
    Random random(5);
    body.set_displacements(random.template field<TestType::dim>(body.mesh().nodes.size(), 1e-3));
    body.set_velocities(random.template field<TestType::dim>(body.mesh().nodes.size(), 1));
    auto const mark = [&](int level, std::size_t of_ten) {
      std::vector<Index> marked;
      auto const levels = refinement_levels<TestType>(body);
      for (std::size_t e = 0; e < levels.size(); ++e)
        if (levels[e] == level && random.below(10) < of_ten)
          marked.push_back(static_cast<Index>(e));
      return std::vector<std::vector<Index>>{marked};
    };
    std::vector<std::size_t> counts;
    for (int k = 0; k < 2; ++k) {
      counts.push_back(refine(body, mark(0, 3)).refined);
      counts.push_back(coarsen(body, mark(1, 9)).merged);
      counts.push_back(refine(body, mark(1, 1)).refined);
    }
    auto const& layout = body.parts().layout;
    return std::tuple{counts,
                      layout.own_masses(),
                      layout.mass_list(),
                      body.mesh().nodes,
                      body.mesh().tables,
                      body.displacements(),
                      body.velocities(),
                      body.forces(),
                      adaptation_energy(body)};
  });
  CHECK((changed.first == changed.second));
  for (std::size_t const count : std::get<0>(changed.first)) CHECK(count > 256);
}

/// Meshes that are wrong in two places, the second of which another thread meets first.
template <class M, Element E>
std::vector<M> spoilt(M const& mesh, E) {
  std::vector<M> all(6, mesh);
  auto const last = mesh.template elements<E>().size() - 1, middle = last / 2;
  auto const element = [&](std::size_t k, std::size_t e) -> auto& {
    return all[k].template elements<E>()[e];
  };
  for (std::size_t e : {last, middle}) {
    std::swap(element(0, e)[0], element(0, e)[1]);
    element(1, e)[2] = static_cast<Index>(mesh.nodes.size() + e);
    element(2, e) = element(2, e - 7);
    all[4].nodes.push_back({});
    auto& node = element(5, e)[E::nodes - 1];  // another one, a little beside
    all[5].nodes.push_back(all[5].nodes[static_cast<std::size_t>(node)]);
    all[5].nodes.back()[0] += 1e-5;
    node = static_cast<Index>(all[5].nodes.size()) - 1;
  }
  for (std::size_t i : {mesh.nodes.size() - 1, mesh.nodes.size() / 2})
    all[3].nodes[i][1] = std::numeric_limits<double>::infinity();
  return all;
}

TEMPLATE_TEST_CASE("errors in meshes do not depend on the number of threads", "[body][errors]",
                   Tri6, Tet4, Tet10, Hex8, Hex20) {
  auto const mesh = shuffled(regular<TestType>());
  CHECK(on_threads([&] { return complaint(mesh); }) == std::pair<std::string, std::string>{});
  auto const meshes = spoilt(mesh, TestType{});
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    INFO("mesh " << k);
    auto const [one, four] = on_threads([&] { return complaint(meshes[k]); });
    CHECK(one == four);
    if (k < 5 || TestType::degree > 1) CHECK(!one.empty());
  }
}

}  // namespace pliant::test::set_up_test
