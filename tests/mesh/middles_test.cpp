#include <pliant/mesh/check.hpp>

#include "support/formulations.hpp"
#include "support/meshes.hpp"

// Elements side by side whose traces differ: nodes between corners that one has and another has not.
namespace pliant::test::middles_test {

template <class M>
Index node_at(M const& mesh, Point<M::dim> const& x) {
  return static_cast<Index>(std::ranges::find(mesh.nodes, x) - mesh.nodes.begin());
}

/// A mesh of elements of type E, in which those with `low` come from the corners of their cell, as elements
/// of type L. Nodes that no element has any more are left out.
template <Element E, Element L, class Low>
Mesh<E, L> partly_lowered(Mesh<E> const& from, Low const& low) {
  Mesh<E, L> to;
  std::vector<Index> number(from.nodes.size(), -1);
  auto const take = [&](Index node) {
    Index& own = number[static_cast<std::size_t>(node)];
    if (own < 0) {
      own = static_cast<Index>(to.nodes.size());
      to.nodes.push_back(from.nodes[static_cast<std::size_t>(node)]);
    }
    return own;
  };
  auto const& elements = from.template elements<E>();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    auto const add = [&]<Element To>(To) {
      Connectivity<To> element;
      for (std::size_t a = 0; a < element.size(); ++a) element[a] = take(elements[e][a]);
      to.template elements<To>().push_back(element);
    };
    low(e) ? add(L{}) : add(E{});
  }
  return to;
}
auto const last = [](std::size_t e) { return e == 1; };

/// Two cells of edge 1 side by side, along x; the second is of type L.
template <Element E, Element L>
Mesh<E, L> two_cells() {
  if constexpr (E::dim == 2)
    return partly_lowered<E, L>(mesh::rectangle<E>({.size = {2, 1}, .cells = {2, 1}}), last);
  else
    return partly_lowered<E, L>(mesh::box<E>({.size = {2, 1, 1}, .cells = {2, 1, 1}}), last);
}

TEST_CASE("a middle node that the element beside does not have is a slave or refused",
          "[mesh][errors]") {
  auto mesh = two_cells<Quad8, Quad4>();
  Index const middle = node_at(mesh, {1, 0.5}), low = node_at(mesh, {1, 0}),
              high = node_at(mesh, {1, 1});
  auto const number = [](Index node) { return std::to_string(node); };
  auto const first = std::min(low, high), second = std::max(low, high);
  CHECK_THROWS_WITH(check(mesh), says("node " + number(middle) + " at (1, 0.5)") &&
                                     says("edge 1 of Quad8 element 0 with nodes") &&
                                     says("edge 3 of Quad4 element 0 with nodes") &&
                                     says("mesh.slaves") && says(number(first) + " (0.5)") &&
                                     says(number(second) + " (0.5)"));
  mesh.slaves = {{middle, {{first, 0.5}, {second, 0.5}}}};
  CHECK_NOTHROW(check(mesh));
  // In the right place, by others than the corners of the edge.
  mesh.slaves = {{middle,
                  {{node_at(mesh, {0.5, 0}), 0.5},
                   {node_at(mesh, {1, 1}), 0.25},
                   {node_at(mesh, {2, 1}), 0.25}}}};
  CHECK_THROWS_WITH(check(mesh), says("node " + number(middle)) && says("come apart"));
}

TEST_CASE("elements of all types that differ in middle nodes are refused", "[mesh][errors]") {
  CHECK_THROWS_WITH((check(two_cells<Quad9, Quad4>())), says("edge 1 of Quad9 element 0"));
  CHECK_THROWS_WITH((check(two_cells<Hex20, Hex8>())),
                    says("of Hex20 element 0") && says("of Hex8 element 0"));
  CHECK_THROWS_WITH((check(two_cells<Hex27, Hex8>())), says("of Hex27 element 0"));
  auto const some = [](std::size_t e) { return e % 3 == 0; };
  CHECK_THROWS_WITH((check(partly_lowered<Tri6, Tri3>(regular_mesh<Tri6>(3), some))),
                    says("of Tri3 element"));
  CHECK_THROWS_WITH((check(partly_lowered<Tet10, Tet4>(regular_mesh<Tet10>(2), some))),
                    says("of Tet4 element"));
  // The order of the types in the mesh does not matter.
  Mesh<Quad4, Quad8> other;
  auto const mesh = two_cells<Quad8, Quad4>();
  other.nodes = mesh.nodes;
  other.elements<Quad4>() = mesh.elements<Quad4>();
  other.elements<Quad8>() = mesh.elements<Quad8>();
  CHECK_THROWS_WITH(check(other), says("edge 1 of Quad8 element 0"));
}

TEST_CASE("a middle of a face that the element beside does not have is refused", "[mesh][errors]") {
  // Twenty nodes of a brick are the first of its twenty-seven: they agree on edges, not on the face.
  auto mesh = two_cells<Hex27, Hex20>();
  Index const middle = node_at(mesh, {1, 0.5, 0.5});
  CHECK_THROWS_WITH(check(mesh), says("node " + std::to_string(middle) + " at (1, 0.5, 0.5)") &&
                                     says("face 1 of Hex27 element 0") &&
                                     says("face 0 of Hex20 element 0") && !says("mesh.slaves"));
  // The mean of the corners is not where eight free nodes put it; it is where four do.
  auto const at = [&](double y, double z) { return node_at(mesh, {1, y, z}); };
  auto const slave = [](Index node, std::vector<Index> masters) {
    std::ranges::sort(masters);
    Slave made{node, {}};
    for (Index m : masters) made.masters.emplace_back(m, 1.0 / static_cast<double>(masters.size()));
    return made;
  };
  std::vector<Index> const corners{at(0, 0), at(0, 1), at(1, 0), at(1, 1)};
  mesh.slaves = {slave(middle, corners)};
  CHECK_THROWS_WITH(check(mesh), says("node " + std::to_string(middle)) && says("come apart"));
  mesh.slaves = {slave(at(0, 0.5), {at(0, 0), at(0, 1)}), slave(at(1, 0.5), {at(1, 0), at(1, 1)}),
                 slave(at(0.5, 0), {at(0, 0), at(1, 0)}), slave(at(0.5, 1), {at(0, 1), at(1, 1)}),
                 slave(middle, corners)};
  CHECK_NOTHROW(check(mesh));
}

TEST_CASE("elements with the same middle nodes fit together", "[mesh]") {
  CHECK_NOTHROW(check(two_cells<Quad9, Quad8>()));
  CHECK_NOTHROW(check(distorted_mesh<Tri6>(4)));
  CHECK_NOTHROW(check(distorted_mesh<Tet10>(3)));
  CHECK_NOTHROW(check(distorted_mesh<Hex20>(3)));
  CHECK_NOTHROW(check(distorted_mesh<Hex27>(3)));
}

TEST_CASE("two middle nodes of one edge are refused unless they are a slit's", "[mesh][errors]") {
  auto mesh = mesh::rectangle<Quad8>({.size = {2, 1}, .cells = {2, 1}});
  Index const middle = node_at(mesh, {1, 0.5}), twin = static_cast<Index>(mesh.nodes.size());
  mesh.nodes.push_back({1, 0.5});
  std::ranges::replace(mesh.elements<Quad8>()[1], middle, twin);
  CHECK_NOTHROW(check(mesh));
  mesh.nodes.back() = {1.01, 0.5};
  CHECK_THROWS_WITH(check(mesh), says("edge 1 of Quad8 element 0") &&
                                     says("edge 3 of Quad8 element 1") && says("node"));
}

TEST_CASE("a uniform state of quadratic beside linear elements leaves no force inside",
          "[mesh][constraint]") {
  int const n = 4;
  auto mesh = partly_lowered<Quad8, Quad4>(distorted_mesh<Quad8>(n),
                                           [](std::size_t e) { return e % 2 == 0; });
  // What the check asks for, until it is satisfied.
  std::vector<std::pair<Index, Index>> edges;
  for (auto const& q : mesh.elements<Quad4>())
    for (auto const& [a, b] : Quad4::edges())
      edges.push_back(std::minmax(q[static_cast<std::size_t>(a)], q[static_cast<std::size_t>(b)]));
  for (auto const& q : mesh.elements<Quad8>())
    for (std::size_t k = 0; k < 4; ++k) {
      std::pair<Index, Index> const edge = std::minmax(q[k], q[(k + 1) % 4]);
      if (std::ranges::find(edges, edge) != edges.end())
        mesh.slaves.push_back({q[4 + k], {{edge.first, 0.5}, {edge.second, 0.5}}});
    }
  REQUIRE(mesh.slaves.size() > 4);
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<Quad8, Gauss<3>, NeoHookean>>{},
            Group<Formulation<Quad4, Gauss<2>, NeoHookean>>{}};
  auto h = Tensor<double, 2>::zero();
  h(0, 0) = 0.1;
  h(0, 1) = 0.3;
  auto const f = forces_at(body, uniform(mesh.nodes, h));
  double inside = 0;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    auto const& x = mesh.nodes[i];
    bool const outside = std::min({x[0] + 0.25, 0.75 - x[0], x[1] - 0.5, 1.5 - x[1]}) < 1e-9;
    if (!outside) inside = std::max({inside, std::abs(f[i][0]), std::abs(f[i][1])});
  }
  CHECK(inside < 1e-12 * largest(f));
}

}  // namespace pliant::test::middles_test
