#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <pliant/error.hpp>
#include <pliant/topology/hierarchy.hpp>

#include "support/at.hpp"

namespace {

using pliant::Error;
using pliant::Index;
using pliant::Quad4;
using pliant::Slave;
using pliant::TreeCell;
using pliant::Tri3;
using pliant::test::at;
using Hierarchy = pliant::Hierarchy<2>;
using Refinement = pliant::Refinement<2>;
using Point = pliant::Point<2>;
using Nodes2 = std::array<Index, 2>;
using Nodes3 = std::array<Index, 3>;
using Nodes4 = std::array<Index, 4>;

enum class Cells { triangles, quads, mixed };

constexpr double width = 2.0, height = 1.0;

Hierarchy hierarchy(std::vector<Point> points, std::vector<Nodes3> triangles,
                    std::vector<Nodes4> quads) {
  return Hierarchy(
      pliant::Mesh<Tri3, Quad4>{std::move(points), {std::move(triangles), std::move(quads)}});
}

Nodes4 four_nodes(Hierarchy const& mesh, Index c) {
  auto const* const nodes = mesh.tree().row(c).nodes;
  return {nodes[0], nodes[1], nodes[2], nodes[3]};
}

// A rectangle whose inner nodes are shifted at random, so that no two cells are alike.
Hierarchy rectangle(Cells kind, Index nx, Index ny, unsigned seed = 1) {
  std::mt19937 random(seed);
  auto const shift = [&] { return 0.4 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  std::vector<Point> points;
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i) {
      bool const inside = i > 0 && i < nx && j > 0 && j < ny;
      points.push_back({width * (i + (inside ? shift() : 0.0)) / nx,
                        height * (j + (inside ? shift() : 0.0)) / ny});
    }
  std::vector<Nodes3> triangles;
  std::vector<Nodes4> quads;
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      Index const a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = c - 1;
      if (kind == Cells::quads || (kind == Cells::mixed && random() % 2 == 0)) {
        quads.push_back({a, b, c, d});
      } else {
        triangles.push_back({a, b, c});
        triangles.push_back({c, d, a});
      }
    }
  return hierarchy(points, triangles, quads);
}

Refinement refine(Hierarchy& mesh, std::vector<Index> const& cells,
                  pliant::RefinementLimits const& limits = {}) {
  return mesh.refine(cells, limits);
}

double cross_at(Hierarchy const& mesh, Index c, std::size_t i) {
  auto const k = mesh.cell(c).corners();
  auto const* const nodes = mesh.tree().row(c).nodes;
  auto const& p = mesh.points()[at(nodes[i])];
  auto const& next = mesh.points()[at(nodes[(i + 1) % k])];
  auto const& last = mesh.points()[at(nodes[(i + k - 1) % k])];
  return (next[0] - p[0]) * (last[1] - p[1]) - (next[1] - p[1]) * (last[0] - p[0]);
}

double area(Hierarchy const& mesh, Index c) {
  auto const* const nodes = mesh.tree().row(c).nodes;
  auto const corners = mesh.cell(c).corners();
  double twice = 0;
  for (std::size_t i = 0; i < corners; ++i) {
    auto const& p = mesh.points()[at(nodes[i])];
    auto const& q = mesh.points()[at(nodes[(i + 1) % corners])];
    twice += p[0] * q[1] - p[1] * q[0];
  }
  return twice / 2;
}

// Everything that can be seen of a hierarchy, as numbers to compare.
std::vector<double> picture(Hierarchy const& mesh) {
  std::vector<double> seen{static_cast<double>(mesh.leaf_count())};
  for (auto const& p : mesh.points()) seen.insert(seen.end(), p.begin(), p.end());
  for (auto const& c : mesh.cells()) {
    for (Index const n : {static_cast<int>(c.corners()), c.parent, c.first_child, int{c.level}})
      seen.push_back(n);
  }
  for (auto const& row : mesh.tree().lists().rows)
    seen.insert(seen.end(), row.numbers.begin(), row.numbers.end());
  for (auto const& s : mesh.slaves()) {
    seen.push_back(s.node);
    for (auto const& [master, weight] : s.masters) seen.insert(seen.end(), {1. * master, weight});
  }
  return seen;
}

std::string message_of(std::function<void()> const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.what();
  }
  return "(no error)";
}

bool mentions(std::string const& text, std::vector<std::string> const& words) {
  for (auto const& word : words)
    if (text.find(word) == std::string::npos) {
      UNSCOPED_INFO("'" << text << "' lacks '" << word << "'");
      return false;
    }
  return true;
}

// The nodes of a mesh by their place: an oracle of hanging nodes that knows nothing of edges. Since
// the mean of two points does not depend on their order, nodes are found by exact comparison.
class Places {
 public:
  explicit Places(Hierarchy const& mesh) : points_(mesh.points()) {
    for (std::size_t i = 0; i < points_.size(); ++i) nodes_.emplace(points_[i], Index(i));
  }
  std::size_t count() const { return nodes_.size(); }
  Index between(Index a, Index b) const {
    auto const &p = points_[at(a)], &q = points_[at(b)];
    auto const found = nodes_.find({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2});
    return found == nodes_.end() ? -1 : found->second;
  }

 private:
  pliant::SharedList<Point> const& points_;
  std::map<Point, Index> nodes_;
};

void check_leaves(Hierarchy const& mesh) {
  double total = 0;
  int bad_corners = 0, astray = 0;
  auto const leaves = mesh.leaves();
  for (Index const c : leaves) {
    auto const& cell = mesh.cell(c);
    total += area(mesh, c);
    for (std::size_t i = 0; i < cell.corners(); ++i) bad_corners += !(cross_at(mesh, c, i) > 0);
    for (Index child = c, up = cell.parent; up >= 0; child = up, up = mesh.cell(up).parent) {
      auto const first = mesh.cell(up).first_child;
      astray += child < first || child >= first + 4;
      astray += mesh.cell(child).level != mesh.cell(up).level + 1;
    }
  }
  CHECK(std::abs(total - width * height) < 1e-12);
  CHECK(bad_corners == 0);
  CHECK(astray == 0);
  CHECK(std::is_sorted(leaves.begin(), leaves.end()));
  CHECK(leaves.size() == mesh.leaf_count());
}

// Returns the number of hanging nodes.
std::size_t check_continuity(Hierarchy const& mesh, std::mt19937& random) {
  Places const places(mesh);
  CHECK(places.count() == mesh.points().size());  // no place has two nodes

  // Any values at the free nodes, a linear function beside them.
  auto const linear = [](Point const& p) { return 3 * p[0] - 7 * p[1] + 2; };
  std::vector<double> any(mesh.points().size()), line(mesh.points().size());
  for (std::size_t i = 0; i < any.size(); ++i) {
    any[i] = static_cast<double>(random()) / 4294967296.0;
    line[i] = linear(mesh.points()[i]);
  }
  auto const slaves = mesh.slaves();
  std::set<Index> constrained;
  for (auto const& s : slaves) constrained.insert(s.node);
  CHECK(constrained.size() == slaves.size());
  for (Index const n : constrained) any[at(n)] = line[at(n)] = std::nan("");

  int bad_weights = 0, bad_masters = 0, bad_lines = 0;
  for (auto const& s : slaves) {
    double sum = 0, any_value = 0, line_value = 0;
    Index previous = -1;
    for (auto const& [master, weight] : s.masters) {
      bad_weights += !(weight > 0);
      bad_masters += master <= previous || constrained.contains(master);
      previous = master;
      sum += weight;
      any_value += weight * any[at(master)];
      line_value += weight * line[at(master)];
    }
    bad_weights += !(std::abs(sum - 1) < 1e-15);  // dyadic numbers: no rounding
    any[at(s.node)] = any_value;
    bad_lines += !(std::abs(line_value - linear(mesh.points()[at(s.node)])) < 1e-13);
  }
  CHECK(bad_weights == 0);
  CHECK(bad_masters == 0);
  CHECK(bad_lines == 0);

  // A node within a side of a leaf hangs there, lies in the middle, and has the mean value.
  int jumps = 0, two_levels = 0;
  std::set<Index> hanging;
  for (Index const c : mesh.leaves()) {
    auto const& cell = mesh.cell(c);
    auto const* const nodes = mesh.tree().row(c).nodes;
    for (std::size_t i = 0; i < cell.corners(); ++i) {
      Index const a = nodes[i], b = nodes[(i + 1) % cell.corners()];
      Index const middle = places.between(a, b);
      if (middle < 0) continue;
      hanging.insert(middle);
      two_levels += places.between(a, middle) >= 0 || places.between(middle, b) >= 0;
      jumps += !(std::abs(any[at(middle)] - (any[at(a)] + any[at(b)]) / 2) < 1e-14);
    }
  }
  CHECK(two_levels == 0);
  CHECK(jumps == 0);
  CHECK(hanging == constrained);
  return hanging.size();
}

// What refine says it did, against what changed.
void check_report(Refinement const& done, Hierarchy const& mesh, std::size_t cells_before,
                  std::size_t nodes_before, std::size_t leaves_before) {
  int bad_parents = 0, bad_nodes = 0;
  for (std::size_t i = 0; i < done.parents.size(); ++i) {
    auto const& parent = mesh.cell(done.parents[i]);
    bad_parents += parent.first_child != Index(cells_before + 4 * i);
    bad_parents += i > 0 && mesh.cell(done.parents[i - 1]).level > parent.level;
  }
  for (std::size_t i = 0; i < done.new_nodes.size(); ++i) {
    auto const& [node, parents] = done.new_nodes[i];
    auto const count = parents.size();
    Point mean{};
    for (auto const& [parent, weight] : parents) {
      bad_nodes += weight != 1.0 / static_cast<double>(count);
      for (std::size_t d = 0; d < 2; ++d) mean[d] += weight * mesh.points()[at(parent)][d];
    }
    bad_nodes += node != Index(nodes_before + i) || (count != 2 && count != 4);
    for (std::size_t d = 0; d < 2; ++d)
      bad_nodes += !(std::abs(mesh.points()[at(node)][d] - mean[d]) < 1e-15);
  }
  CHECK(bad_parents == 0);
  CHECK(bad_nodes == 0);
  CHECK(mesh.cells().size() == cells_before + 4 * done.parents.size());
  CHECK(mesh.points().size() == nodes_before + done.new_nodes.size());
  CHECK(mesh.leaf_count() == leaves_before + 3 * done.parents.size());
}

}  // namespace

TEST_CASE("a triangle becomes three corners and a middle turned by half a turn", "[hierarchy]") {
  auto mesh = hierarchy({{0, 0}, {2, 0}, {0, 2}}, {{0, 1, 2}}, {});

  auto const done = refine(mesh, {0});

  REQUIRE(done.parents == std::vector<Index>{0});
  REQUIRE(std::ranges::equal(mesh.points(),
                             std::vector<Point>{{0, 0}, {2, 0}, {0, 2}, {1, 0}, {1, 1}, {0, 1}}));
  REQUIRE(mesh.leaves() == std::vector<Index>{1, 2, 3, 4});
  CHECK(mesh.cell(0).first_child == 1);
  CHECK(four_nodes(mesh, 1) == Nodes4{0, 3, 5, -1});
  CHECK(four_nodes(mesh, 2) == Nodes4{3, 1, 4, -1});
  CHECK(four_nodes(mesh, 3) == Nodes4{5, 4, 2, -1});
  CHECK(four_nodes(mesh, 4) == Nodes4{4, 5, 3, -1});
}

TEST_CASE("a quadrilateral becomes four corners numbered like itself", "[hierarchy]") {
  auto mesh = hierarchy({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {}, {{0, 1, 2, 3}});

  auto const done = refine(mesh, {0});

  REQUIRE(mesh.points().size() == 9);
  CHECK(mesh.points()[8] == Point{1, 1});
  auto const centre = done.new_nodes.back().parents;
  CHECK(std::vector(centre.begin(), centre.end()) ==
        std::vector<std::pair<Index, double>>{{0, 0.25}, {1, 0.25}, {2, 0.25}, {3, 0.25}});
  CHECK(four_nodes(mesh, 1) == Nodes4{0, 4, 8, 7});
  CHECK(four_nodes(mesh, 2) == Nodes4{4, 1, 5, 8});
  CHECK(four_nodes(mesh, 3) == Nodes4{8, 5, 2, 6});
  CHECK(four_nodes(mesh, 4) == Nodes4{7, 8, 6, 3});
  CHECK(mesh.slaves().empty());
}

TEST_CASE("a coarser neighbour is refined first, and nothing else", "[hierarchy]") {
  auto mesh = rectangle(Cells::quads, 4, 1);
  REQUIRE(refine(mesh, {1}).parents == std::vector<Index>{1});  // children 4 to 7
  auto const slaves = mesh.slaves();
  REQUIRE(slaves.size() == 2);
  CHECK(slaves[0].masters == std::vector<std::pair<Index, double>>{{2, 0.5}, {7, 0.5}});
  CHECK(slaves[1].masters == std::vector<std::pair<Index, double>>{{1, 0.5}, {6, 0.5}});

  auto const done = refine(mesh, {5});  // at the lower right, beside cell 2

  CHECK(done.parents == std::vector<Index>{2, 5});
  CHECK(mesh.is_leaf(0));
  CHECK(mesh.is_leaf(3));
}

TEST_CASE("closure runs on through ever coarser neighbours", "[hierarchy]") {
  auto mesh = rectangle(Cells::quads, 3, 1);
  Index corner = 0;
  for (int level = 0; level < 4; ++level) {
    REQUIRE(refine(mesh, {corner}).parents == std::vector<Index>{corner});
    corner = mesh.cell(corner).first_child;
  }
  // Along the bottom the levels are now 4 4 3 2 1 0 0.

  auto const done = refine(mesh, {corner + 1});

  std::vector<int> levels;
  for (Index const c : done.parents) levels.push_back(mesh.cell(c).level);
  CHECK(levels == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(done.parents.front() == 1);
  CHECK(mesh.is_leaf(2));
}

TEST_CASE("slaves of slaves are composed down to free nodes", "[hierarchy]") {
  // A triangle with a neighbour at each side; its middle is refined again and again, which leaves
  // the neighbours alone: every new node hangs between hanging nodes.
  auto mesh = hierarchy({{0, 0}, {4, 0}, {0, 4}, {4, 4}, {-4, 2}, {2, -4}},
                        {{0, 1, 2}, {1, 3, 2}, {0, 2, 4}, {0, 5, 1}}, {});
  Index middle = 0;
  auto const refine_middle = [&] {
    auto const done = refine(mesh, {middle});
    middle = mesh.cell(middle).first_child + 3;
    return done;
  };
  CHECK(refine_middle().new_nodes.size() == 3);
  auto const done = refine_middle();
  REQUIRE(done.parents.size() == 1);
  REQUIRE(mesh.slaves().size() == 6);

  // Sides of the middle join the midpoints of (1, 2), (2, 0), (0, 1): a common end weighs twice.
  auto const slaves = mesh.slaves();
  using Masters = std::vector<std::pair<Index, double>>;
  CHECK(slaves[3].masters == Masters{{0, 0.25}, {1, 0.25}, {2, 0.5}});
  CHECK(slaves[4].masters == Masters{{0, 0.5}, {1, 0.25}, {2, 0.25}});
  CHECK(slaves[5].masters == Masters{{0, 0.25}, {1, 0.5}, {2, 0.25}});

  for (int i = 0; i < 8; ++i) REQUIRE(refine_middle().parents.size() == 1);
  REQUIRE(mesh.slaves().size() == 30);
  for (auto const& s : mesh.slaves()) CHECK(s.masters.back().first <= 2);
  std::mt19937 random(7);
  CHECK(check_continuity(mesh, random) == 30);
}

TEST_CASE("random refinement keeps area, orientation, levels, continuity and marks",
          "[hierarchy]") {
  auto const kind = GENERATE(Cells::triangles, Cells::quads, Cells::mixed);
  CAPTURE(static_cast<int>(kind));
  auto mesh = rectangle(kind, 6, 3);
  std::mt19937 random(2013);
  std::size_t closures = 0, most_hanging = 0, composed = 0;
  for (int round = 0; round < 1000; ++round) {
    // Mostly near a corner, so that levels grow apart; a repetition now and then.
    auto const leaves = mesh.leaves();
    std::vector<Index> marked;
    for (auto n = random() % 3 + 1; n > 0; --n)
      marked.push_back(leaves[random() % (round % 4 == 0 ? leaves.size() : leaves.size() / 3 + 1)]);
    if (round % 5 == 0) marked.push_back(marked.front());
    auto const cells = mesh.cells().size(), nodes = mesh.points().size();

    auto const done = refine(mesh, marked, {.max_level = 7});

    closures += done.parents.size() > std::set(marked.begin(), marked.end()).size();
    if (round % 20 == 19) {
      check_report(done, mesh, cells, nodes, leaves.size());
      check_leaves(mesh);
      most_hanging = std::max(most_hanging, check_continuity(mesh, random));
      for (auto const& s : mesh.slaves()) composed += s.masters.size() > 2;
    }
  }
  int deepest = 0;
  for (auto const& c : mesh.cells()) deepest = std::max(deepest, int{c.level});
  // The trial reached what it is meant to try.
  CHECK(deepest >= 4);
  CHECK(closures > 20);
  CHECK(most_hanging > 100);
  CHECK((kind == Cells::quads) == (composed == 0));
}

TEST_CASE("the result depends on the set of marked cells, not on order or repetition",
          "[hierarchy]") {
  auto one = rectangle(Cells::mixed, 5, 4), other = one;
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    auto const leaves = one.leaves();
    std::vector<Index> marked;
    for (int i = 0; i < 8; ++i) marked.push_back(leaves[random() % leaves.size()]);
    auto backwards = std::vector<Index>(marked.rbegin(), marked.rend());
    backwards.push_back(marked[3]);

    auto const first = refine(one, marked), second = refine(other, backwards);

    REQUIRE(first.parents == second.parents);
  }
  CHECK(one.cells().size() > 500);
  CHECK(picture(one) == picture(other));
}

TEST_CASE("a failed refinement leaves the hierarchy as it was", "[hierarchy]") {
  auto mesh = rectangle(Cells::mixed, 4, 3);
  refine(mesh, {0, 5, 9});
  refine(mesh, {mesh.cell(5).first_child + 1, mesh.cell(9).first_child + 2});
  auto const before = picture(mesh);
  // A leaf with a coarser neighbour, so that closure counts too.
  Index wanted = -1;
  for (Index const c : mesh.leaves()) {
    auto trial = mesh;
    if (refine(trial, {c}).parents.size() > 1) wanted = c;
  }
  REQUIRE(wanted >= 0);
  auto trial = mesh;
  refine(trial, {wanted});
  auto const nodes = trial.points().size(), leaves = trial.leaf_count();
  auto const last = static_cast<Index>(mesh.cells().size());

  CHECK(mentions(message_of([&] { refine(mesh, {wanted}, {.nodes = nodes - 1}); }),
                 {"nodes", std::to_string(nodes), std::to_string(nodes - 1), "raise the limit"}));
  CHECK(mentions(message_of([&] { refine(mesh, {wanted}, {.leaves = leaves - 1}); }),
                 {"leaves", std::to_string(leaves), std::to_string(leaves - 1)}));
  CHECK(mentions(message_of([&] {
                   refine(mesh, {wanted, last});
                 }),
                 {"cell " + std::to_string(last), std::to_string(last - 1)}));
  CHECK(mentions(message_of([&] { refine(mesh, {wanted, -1}); }), {"cell -1"}));
  CHECK(mentions(message_of([&] {
                   refine(mesh, {wanted, 5});
                 }),
                 {"cell 5 again", std::to_string(mesh.cell(5).first_child)}));
  CHECK(picture(mesh) == before);

  refine(mesh, {wanted}, {.nodes = nodes, .leaves = leaves});  // just enough
  CHECK(picture(mesh) == picture(trial));
  // So it is for neighbours, which share the nodes between them.
  refine(trial, trial.leaves());
  CHECK(message_of([&] {
          refine(mesh, mesh.leaves(),
                 {.nodes = trial.points().size(), .leaves = trial.leaf_count()});
        }) == "(no error)");
  CHECK(picture(mesh) == picture(trial));
}

TEST_CASE("marked cells at the greatest level are skipped, closure stays below it", "[hierarchy]") {
  auto mesh = rectangle(Cells::mixed, 3, 3);
  pliant::RefinementLimits const limits{.max_level = 2};
  for (int round = 0; round < 4; ++round) refine(mesh, mesh.leaves(), limits);
  auto const before = picture(mesh);

  for (Index const c : mesh.leaves()) REQUIRE(mesh.cell(c).level == 2);
  CHECK(refine(mesh, mesh.leaves(), limits).parents.empty());
  // Nothing to do is no breach of a limit that is already passed.
  CHECK(refine(mesh, mesh.leaves(), {.nodes = 1, .leaves = 1, .max_level = 2}).new_nodes.empty());
  CHECK(refine(mesh, {}).parents.empty());
  CHECK(picture(mesh) == before);
}

TEST_CASE("a mesh that cannot be refined soundly is refused, and the message says where",
          "[hierarchy]") {
  double const nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  std::vector<Point> const points{{0, 0}, {1, 0}, {1, 1},   {0, 1},   {0.3, 0.3}, {2, 0},
                                  {2, 2}, {4, 4}, {nan, 1}, {inf, 1}, {-1, 3}};
  auto const triangle = [&](Nodes3 const& bad) {
    return message_of([&] { hierarchy(points, {{0, 1, 2}, bad}, {}); });
  };
  auto const quad = [&](Nodes4 const& bad) {
    return message_of([&] { hierarchy(points, {}, {bad}); });
  };
  CHECK(triangle({0, 2, 3}) == "(no error)");
  CHECK(mentions(triangle({0, 3, 2}), {"cell 1", "inverted", "counter-clockwise"}));
  CHECK(mentions(triangle({0, 2, 6}), {"cell 1", "degenerate"}));
  CHECK(mentions(triangle({2, 7, 6}), {"cell 1", "degenerate"}));
  CHECK(mentions(triangle({0, 2, 2}), {"cell 1", "degenerate"}));
  CHECK(mentions(triangle({0, 2, 8}), {"cell 1", "not finite"}));
  CHECK(mentions(triangle({0, 2, 9}), {"cell 1", "not finite"}));
  CHECK(mentions(triangle({0, 2, 11}), {"cell 1", "node 11", "0 to 10"}));
  CHECK(mentions(triangle({0, -1, 3}), {"cell 1", "node -1"}));
  CHECK(mentions(triangle({0, 1, 3}), {"cell 1", "overlaps", "node 0 to 1"}));
  CHECK(quad({0, 1, 2, 3}) == "(no error)");
  CHECK(mentions(quad({0, 1, 4, 3}), {"cell 0", "node 4", "convex"}));
  CHECK(mentions(quad({0, 2, 1, 3}), {"cell 0", "convex"}));
  CHECK(mentions(quad({0, 1, 5, 3}), {"cell 0", "degenerate"}));
  // Three cells at an edge: the third lies on the side of one of the others.
  CHECK(mentions(message_of([&] {
                   hierarchy(points, {{0, 1, 2}, {0, 2, 3}, {0, 2, 10}}, {});
                 }),
                 {"cell 2", "overlaps"}));
}

TEST_CASE("families of several degrees, and parts of degree two, are not merged", "[hierarchy]") {
  using pliant::CellNodes;
  auto mesh = rectangle(Cells::quads, 2, 2);
  mesh.refine(std::array<Index, 1>{0});
  Index const child = mesh.cell(0).first_child;
  std::array<Index, 4> const family{child, child + 1, child + 2, child + 3};
  CHECK(mesh.families(family) == std::vector<Index>{0});
  mesh.raise({{child + 2, CellNodes::all}});
  CHECK(mesh.families(family).empty());
  mesh.raise({{child, CellNodes::all}, {child + 1, CellNodes::all}, {child + 3, CellNodes::all}});
  CHECK(mesh.families(family) == std::vector<Index>{0});

  mesh.split({{3, pliant::Division::four_triangles}});
  Index const part = mesh.cell(3).first_child;
  std::array<Index, 4> const parts{part, part + 1, part + 2, part + 3};
  CHECK(mesh.split_cells(parts) == std::vector<Index>{3});
  std::vector<pliant::CellConversion> raised;
  for (Index const c : parts) raised.push_back({c, CellNodes::edges});
  mesh.raise(raised);
  CHECK(mesh.split_cells(parts).empty());
}

TEST_CASE("composition sums the weights of masters reached twice and refuses circles", "[slave]") {
  auto const slaves = pliant::compose(
      {{9, {{0, 0.5}, {1, 0.5}}}, {3, {{9, 0.5}, {1, 0.25}, {2, 0.25}}}, {4, {{3, 1.0}}}});

  REQUIRE(slaves.size() == 3);
  using Masters = std::vector<std::pair<Index, double>>;
  CHECK((slaves[0].node == 3 && slaves[1].node == 4 && slaves[2].node == 9));
  CHECK(slaves[0].masters == Masters{{0, 0.25}, {1, 0.5}, {2, 0.25}});
  CHECK(slaves[1].masters == slaves[0].masters);
  CHECK(mentions(message_of([] {
                   (void)pliant::compose({{1, {{2, 1.0}}}, {2, {{1, 1.0}}}});
                 }),
                 {"node 1", "master 2"}));
  CHECK(mentions(message_of([] { (void)pliant::compose({{1, {{1, 1.0}}}}); }), {"node 1"}));
  CHECK(mentions(message_of([] {
                   (void)pliant::compose({{1, {{0, 1.0}}}, {1, {{2, 1.0}}}});
                 }),
                 {"node 1", "twice"}));
}
