#include <cmath>
#include <map>
#include <set>
#include <string>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/formulation/mass.hpp>
#include <pliant/topology/hierarchy.hpp>

#include "support/at.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "topology/cells_at_edges.hpp"
#include "topology/level_jumps.hpp"
#include "topology/side_corners.hpp"

namespace pliant::test::refined_cells_test {

/// Cells that are sheared boxes and their parts, so that each is an affine image of its reference cell; in
/// no order.
template <Element E>
Mesh<E> sheared_mesh(int n) {
  auto mesh = [&] {
    if constexpr (E::degree > 1)
      return mesh::raised<E>(regular_mesh<LinearOf<E>>(n));
    else
      return regular_mesh<E>(n);
  }();
  for (auto& x : mesh.nodes) {
    x[0] += 0.25 * x[1];  // dyadic, as all places are then: no rounding
    if constexpr (E::dim == 3) x[1] -= 0.5 * x[2];
  }
  return shuffled(mesh);
}

template <Element E>
Connectivity<E> nodes_of(Hierarchy<E::dim> const& mesh, Index c) {
  auto const list = mesh.tree().element_nodes(c);
  Connectivity<E> nodes;
  REQUIRE(list.count == nodes.size());
  std::ranges::copy(list, nodes.begin());
  return nodes;
}
template <Element E>
Nodal<E, double> places(Hierarchy<E::dim> const& mesh, Connectivity<E> const& nodes) {
  Nodal<E, double> x;
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) x(a, k) = mesh.points()[at(nodes[at(a)])][at(k)];
  return x;
}
template <Element E>
double volume_of(Hierarchy<E::dim> const& mesh, Index c) {
  return volume<E, MassQuadrature<E>>(places<E>(mesh, nodes_of<E>(mesh, c)));
}

/// The place on the cell of an affine element that a point has.
template <Element E>
Vector<double, E::dim> local(Nodal<E, double> const& x, Point<E::dim> const& p) {
  constexpr int dim = E::dim;
  auto const gradient = shape_gradient<E>(E::place(0));
  Tensor<double, dim> map{};
  Vector<double, dim> from{};
  for (int k = 0; k < dim; ++k) {
    for (int l = 0; l < dim; ++l)
      for (int a = 0; a < E::nodes; ++a) map(k, l) += x(a, k) * gradient(a, l);
    from[k] = p[at(k)] - x(0, k);
  }
  return E::place(0) + (1 / determinant(map)) * (transpose(cofactor(map)) * from);
}
template <class Cell>
bool contains(Vector<double, Cell::dim> const& xi) {
  auto const weights = Cell::linear(xi);
  for (int a = 0; a < Cell::corners; ++a)
    if (weights[a] < -1e-9) return false;
  if constexpr (std::same_as<Cell, Wedge>) return std::abs(xi[2]) < 1 + 1e-9;
  if constexpr (TensorCell<Cell>)
    for (int k = 0; k < Cell::dim; ++k)
      if (std::abs(xi[k]) > 1 + 1e-9) return false;
  return true;
}

/// A polynomial that the elements' shape functions span.
template <Element E>
double polynomial(Point<E::dim> const& x) {
  double value = 2;
  for (double y : x) value += 3 * y;
  return E::degree == 1 ? value : value + x[0] * x[0] - 2 * x[0] * x[1] + 0.5 * x[1] * x[1];
}

/// Leaves fill the body with positive volumes, no place has two nodes, none is unused; any values at free
/// nodes make one continuous field, and polynomials of the elements' degree are among these.
template <Element E>
void check_mesh(Hierarchy<E::dim> const& mesh, double total, Random& random) {
  double sum = 0, least = 1e300;
  std::vector<bool> used(mesh.points().size(), false);
  auto const leaves = mesh.leaves();
  for (Index c : leaves) {
    double const v = volume_of<E>(mesh, c);
    sum += v;
    least = std::min(least, v);
    for (Index node : nodes_of<E>(mesh, c)) used[at(node)] = true;
  }
  CHECK(leaves.size() == mesh.leaf_count());
  CHECK(std::abs(sum - total) < 1e-13);
  CHECK(least > 0);
  CHECK(std::ranges::count(used, false) == 0);
  CHECK(std::set(mesh.points().begin(), mesh.points().end()).size() == mesh.points().size());

  std::vector<double> any(mesh.points().size()), exact(any.size());
  for (std::size_t i = 0; i < any.size(); ++i) {
    any[i] = random();
    exact[i] = polynomial<E>(mesh.points()[i]);
  }
  int wrong_weights = 0;
  for (auto const& [node, masters] : mesh.slaves()) {
    double total_weight = 0, own = 0, value = 0;
    for (auto const& [master, weight] : masters) {
      total_weight += weight;
      own += weight * any[at(master)];
      value += weight * exact[at(master)];
    }
    any[at(node)] = own;  // masters are free: the order does not matter
    wrong_weights += std::abs(total_weight - 1) > 1e-14;
    wrong_weights += std::abs(value - exact[at(node)]) > 1e-12;
  }
  CHECK(wrong_weights == 0);

  int jumps = 0, inside = 0;
  for (Index c : leaves) {
    auto const nodes = nodes_of<E>(mesh, c);
    auto const x = places<E>(mesh, nodes);
    Point<E::dim> low, high;
    for (std::size_t k = 0; k < E::dim; ++k) {
      low[k] = high[k] = x(0, static_cast<int>(k));
      for (int a = 1; a < E::nodes; ++a) {
        low[k] = std::min(low[k], x(a, static_cast<int>(k)));
        high[k] = std::max(high[k], x(a, static_cast<int>(k)));
      }
    }
    for (std::size_t i = 0; i < any.size(); ++i) {
      auto const& p = mesh.points()[i];
      bool outside = false;
      for (std::size_t k = 0; k < E::dim; ++k) outside = outside || p[k] < low[k] || p[k] > high[k];
      if (outside) continue;
      auto const xi = local<E>(x, p);
      if (!contains<typename E::cell>(xi)) continue;
      auto const shape = E::shape(xi);
      double value = 0;
      for (int a = 0; a < E::nodes; ++a) value += shape[a] * any[at(nodes[at(a)])];
      jumps += std::abs(value - any[i]) > 1e-12;
      ++inside;
    }
  }
  CHECK(jumps == 0);
  CHECK(inside >= static_cast<int>(leaves.size()) * E::nodes);
}

/// Random leaves, most of them near the first.
std::vector<Index> some_of(std::vector<Index> const& leaves, Random& random, std::size_t count) {
  std::vector<Index> marked;
  for (std::size_t i = 0; i < count; ++i)
    marked.push_back(leaves[random.below(i % 2 == 0 ? leaves.size() : leaves.size() / 4 + 1)]);
  return marked;
}

TEMPLATE_TEST_CASE("every element's mesh stays sound under refinement and coarsening at random",
                   "[topology]", Tri3, Tri6, Quad4, Quad8, Quad9, Tet4, Tet10, Hex8, Hex20, Hex27,
                   Wedge6) {
  using E = TestType;
  constexpr int dim = E::dim;
  auto const initial = sheared_mesh<E>(dim == 2 ? 4 : 2);
  Hierarchy<dim> mesh(initial);
  Random random(11);
  double const total = 1;
  check_mesh<E>(mesh, total, random);
  REQUIRE(mesh.slaves().empty());

  std::size_t merged = 0, most_hanging = 0, composed = 0;
  int deepest = 0;
  for (int round = 0; round < (dim == 2 ? 24 : 13); ++round) {
    auto const nodes = mesh.points();
    if (round % 3 == 2) {
      std::vector<Index> marked = mesh.leaves();
      std::erase_if(marked, [&](Index) { return random.below(40) == 0; });
      auto const done = mesh.coarsen(marked);
      merged += done.parents.size();
      auto const& renumbered = done.renumbered.nodes;
      REQUIRE(at(renumbered.first()) + renumbered.others().size() == nodes.size());
      for (std::size_t i = 0; i < nodes.size(); ++i)
        if (Index const now = renumbered[static_cast<Index>(i)]; now >= 0)
          CHECK(mesh.points()[at(now)] == nodes[i]);
      CHECK(mesh.points().size() + done.gone.size() == nodes.size());
      for (auto const& [node, parents] : done.gone) {
        double value = 0;
        for (auto const& [parent, weight] : parents) {
          CHECK(renumbered[parent] >= 0);
          value += weight * polynomial<E>(nodes[at(parent)]);
        }
        CHECK(value == Approx(polynomial<E>(nodes[at(node)])).epsilon(1e-12));
      }
      for (Index c : done.parents) CHECK(mesh.is_leaf(c));
    } else {
      auto const done = mesh.refine(some_of(mesh.leaves(), random, 3), {.max_level = 4});
      REQUIRE(mesh.points().size() == nodes.size() + done.new_nodes.size());
      for (std::size_t i = 0; i < done.new_nodes.size(); ++i)
        CHECK(done.new_nodes[i].node == static_cast<Index>(nodes.size() + i));
    }
    for (auto const& cell : mesh.cells()) deepest = std::max(deepest, int{cell.level});
    most_hanging = std::max(most_hanging, mesh.slaves().size());
    for (auto const& slave : mesh.slaves()) composed += slave.masters.size() > 9;
    CHECK(count_level_jumps(mesh) == 0);
    CHECK(count_other_corners(mesh) == 0);
    CHECK(count_edges_with_other_cells(mesh) == 0);
    if (round % 3 > 0) check_mesh<E>(mesh, total, random);
  }
  // The trial reached what it is meant to try.
  CHECK(deepest >= 3);
  CHECK(merged > 3);
  CHECK(most_hanging > 10);

  // Back to where it came from, node for node.
  for (int level = 0; level < 10 && mesh.leaf_count() > initial.template elements<E>().size();
       ++level)
    mesh.coarsen(mesh.leaves());
  CHECK(std::ranges::equal(mesh.points(), initial.nodes));
  REQUIRE(mesh.leaf_count() == initial.template elements<E>().size());
  for (Index c = 0; c < static_cast<Index>(mesh.leaf_count()); ++c)
    CHECK(nodes_of<E>(mesh, c) == initial.template elements<E>()[at(c)]);
  CHECK(mesh.slaves().empty());
  CHECK(mesh.cells().size() == mesh.leaf_count());
  // What a tree knows of edges and sides is as it was at first: it refines as a new one does.
  Hierarchy<dim> fresh(initial);
  auto const first = mesh.refine(mesh.leaves()), second = fresh.refine(fresh.leaves());
  CHECK(mesh.points() == fresh.points());
  for (Index c : fresh.leaves()) CHECK(nodes_of<E>(mesh, c) == nodes_of<E>(fresh, c));
}

TEST_CASE("the tetrahedra of all generations are of three similar shapes at most", "[topology]") {
  Mesh<Tet4> const one{{{0, 0, 0}, {1, 0.2, 0}, {0.1, 1.1, 0.3}, {0.3, 0.2, 0.9}},
                       {{{0, 1, 2, 3}}}};
  Hierarchy<3> mesh(one);
  std::set<std::vector<long>> shapes;
  for (int level = 0; level < 5; ++level) {
    mesh.refine(mesh.leaves());
    shapes.clear();
    for (Index c : mesh.leaves()) {
      auto const x = places<Tet4>(mesh, nodes_of<Tet4>(mesh, c));
      CHECK(volume_of<Tet4>(mesh, c) > 0);
      std::vector<long> lengths;  // of edges, in the unit of the level
      for (auto const& [a, b] : Tetrahedron::edges()) {
        double square = 0;
        for (int k = 0; k < 3; ++k) square += (x(a, k) - x(b, k)) * (x(a, k) - x(b, k));
        lengths.push_back(std::lround(1e6 * square * std::pow(4, level + 1)));
      }
      std::ranges::sort(lengths);
      shapes.insert(lengths);
    }
    CHECK(shapes.size() <= 3);
  }
  CHECK(shapes.size() == 3);
}

TEST_CASE("behind the middle of a tetrahedron's side the coarser neighbour is refined too",
          "[topology]") {
  // Such a child shares no edge with the neighbour, only a side inside the neighbour's.
  Mesh<Tet4> const two{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
                       {{{0, 1, 2, 3}, {1, 2, 3, 4}}}};
  Hierarchy<3> mesh(two);
  mesh.refine(std::vector<Index>{0});
  int behind = 0;
  for (Index c = mesh.cell(0).first_child; c < mesh.cell(0).first_child + 8; ++c) {
    int on_side = 0, corners = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      auto const& p = mesh.points()[at(mesh.tree().row(c).nodes[a])];
      on_side += p[0] + p[1] + p[2] == 1;
      corners += p[0] == 1 || p[1] == 1 || p[2] == 1;
    }
    if (on_side != 3 || corners > 0) continue;
    ++behind;
    auto trial = mesh;
    CHECK(trial.refine(std::vector<Index>{c}).parents == std::vector<Index>{1, c});
  }
  CHECK(behind == 1);
}

TEST_CASE("masses of nodes that hang go by magnitudes, and move at their masters' mean speed",
          "[topology]") {
  Interpolation const quadratic({{3, {{0, 3. / 8}, {1, 3. / 4}, {2, -1. / 8}}}});
  CHECK(quadratic.magnitude() == 1.25);
  std::vector<double> mass{1, 2, 3, 10};
  quadratic.hand_masses([&](Index i, int) -> double& { return mass[at(i)]; }, 1);
  CHECK(mass == std::vector<double>{4, 8, 4, 0});
  std::vector<double> speed{1, 2, 4, 99};
  quadratic.apply_masses([&](Index i, int) -> double& { return speed[at(i)]; }, 1);
  CHECK(speed[3] == Approx(0.3 * 1 + 0.6 * 2 + 0.1 * 4).epsilon(1e-15));
  Interpolation const linear({{2, {{0, 0.25}, {1, 0.75}}}});
  CHECK(linear.magnitude() == 1);
  std::vector<double> other{1, 2, 8};
  linear.hand_masses([&](Index i, int) -> double& { return other[at(i)]; }, 1);
  CHECK(other == std::vector<double>{3, 8, 0});
}

TEST_CASE("a family stays where a child is not marked or a neighbour is too fine", "[topology]") {
  Hierarchy<3> mesh(sheared_mesh<Hex8>(2));  // 2 × 1 × 1
  mesh.refine(std::vector<Index>{0, 1});
  auto const of = [&](Index c) {
    std::vector<Index> children(8);
    for (Index i = 0; i < 8; ++i) children[at(i)] = mesh.cell(c).first_child + i;
    return children;
  };
  auto some = of(0);
  some.pop_back();
  CHECK(mesh.coarsen(some).parents.empty());
  // A child of cell 1 that touches cell 0's children is refined: cell 0 may not become coarse.
  Index touching = -1, away = -1;
  for (Index c : of(1)) {
    auto trial = mesh;
    trial.refine(std::vector<Index>{c});
    (trial.families(of(0)).empty() ? touching : away) = c;
  }
  REQUIRE((touching >= 0 && away >= 0));
  mesh.refine(std::vector<Index>{away});
  CHECK(mesh.families(of(0)) == std::vector<Index>{0});
  mesh.refine(std::vector<Index>{touching});
  auto const before = mesh.points();
  CHECK(mesh.coarsen(of(0)).parents.empty());
  CHECK(mesh.points() == before);
  CHECK_THROWS_WITH(mesh.coarsen(std::vector<Index>{0}), says("cell 0") && says("mark leaves"));
  CHECK_THROWS_WITH(mesh.coarsen(std::vector<Index>{-1}), says("cell -1"));
  // The fine ones first, then the others; the numbers of cells that stay move up.
  CHECK(mesh.coarsen(mesh.leaves()).parents.size() == 2);
  auto const done = mesh.coarsen(mesh.leaves());
  CHECK(done.parents == std::vector<Index>{0, 1});
  CHECK(mesh.points().size() == 12);
}

TEST_CASE("an edge of more cells than can be counted is refused", "[topology]") {
  constexpr Index most = CellsAtEdge::most / 4;
  auto const fan = [](Index cells) {
    Mesh<Tet4> mesh{.nodes = {{0, 0, -1}, {0, 0, 1}}};
    for (Index k = 0; k < cells; ++k) {
      double const angle = 6.28 * k / cells;
      mesh.nodes.push_back({std::cos(angle), std::sin(angle), 0});
      mesh.elements<Tet4>().push_back({0, 1, 2 + k, 2 + (k + 1) % cells});
    }
    return mesh;
  };
  Hierarchy<3> const just(fan(most));
  CHECK(just.tree().edges()[0].cells.leaves() == most);
  CHECK_THROWS_WITH(Hierarchy<3>(fan(most + 1)),
                    says("cell " + std::to_string(most)) && says("from node 0 to 1"));
}

TEST_CASE("a side has two cells at most", "[topology]") {
  Mesh<Tet4> mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0.25, 0.25, 2}};
  auto& elements = std::get<0>(mesh.tables);
  elements = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  Hierarchy<3> const two(mesh);
  Index shared = 0;
  for (auto const& side : two.tree().sides()) shared += side.cells[1] >= 0;
  CHECK(shared == 1);
  elements.push_back({0, 1, 2, 5});
  CHECK_THROWS_WITH(Hierarchy<3>(mesh),
                    says("cell 2 shares the side at the nodes 0, 2 and 1 with two others"));
}

TEST_CASE("limits count nodes and leaves exactly", "[topology]") {
  auto const count = []<Element E>(E) {
    INFO(E::name());
    Hierarchy<E::dim> mesh(sheared_mesh<E>(2));
    Random random(3);
    for (int round = 0; round < 3; ++round) {
      auto trial = mesh;
      auto const marked = some_of(mesh.leaves(), random, 2);
      trial.refine(marked);
      auto const nodes = trial.points().size(), leaves = trial.leaf_count();
      CHECK_THROWS_WITH(mesh.refine(marked, {.nodes = nodes - 1}),
                        says(std::to_string(nodes) + " nodes in all"));
      CHECK_THROWS_WITH(mesh.refine(marked, {.leaves = leaves - 1}),
                        says(std::to_string(leaves) + " leaves in all"));
      mesh.refine(marked, {.nodes = nodes, .leaves = leaves});
      CHECK(mesh.points() == trial.points());
    }
  };
  count(Tri6{});
  count(Quad8{});
  count(Quad9{});
  count(Tet4{});
  count(Tet10{});
  count(Hex8{});
  count(Hex20{});
  count(Hex27{});
  count(Wedge6{});
}

}  // namespace pliant::test::refined_cells_test
