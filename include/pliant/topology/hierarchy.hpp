#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/compose.hpp>

namespace pliant {

/// What a call of Hierarchy::refine did.
struct Refinement {
  std::vector<Index> parents;      ///< refined cells, closure included, coarser ones first
  std::vector<NewNode> new_nodes;  ///< ascending; they follow the nodes that were there
};

/// Beyond what Hierarchy::refine throws Error, or leaves cells alone.
struct RefinementLimits {
  std::size_t nodes = std::numeric_limits<std::size_t>::max();   ///< most nodes in all
  std::size_t leaves = std::numeric_limits<std::size_t>::max();  ///< most leaves in all
  /// Marked cells of this level are left alone. Beyond some 40 levels double coordinates of order
  /// one no longer tell nodes apart.
  int max_level = 30;
};

/// The refinement tree of a plane mesh of triangles and quadrilaterals, mixed at will. Refinement
/// is red: a cell becomes four. Child i lies in corner i and is numbered like its parent, so that
/// both have the same node i; the fourth child of a triangle is the parent turned by half a turn in
/// its middle, its node i being the midpoint that faces the parent's node i. Levels differ by one
/// at most across an edge; hanging nodes are slaves. Numbers stay for good: refinement only
/// appends.
///
///       2            3------+------2
///      /2\           |  3   |  2   |
///     +---+          +------+------+
///    /0\3/1\         |  0   |  1   |
///   0---+---1        0------+------1
class Hierarchy {
 public:
  using Point = std::array<double, 2>;  ///< x, y in m

  /// Of no cells.
  Hierarchy() = default;
  /// Takes points, and cells by their nodes; the triangles are numbered first. Throws Error for
  /// nodes out of range, points that are not finite, cells that are not strictly convex and
  /// counter-clockwise, and cells that overlap at an edge.
  Hierarchy(std::span<Point const> points, std::span<std::array<Index, 3> const> triangles,
            std::span<std::array<Index, 4> const> quads)
      : points_(points.begin(), points.end()),
        tree_(checked_cells(points, triangles, quads), static_cast<Index>(points.size())),
        leaf_count_(triangles.size() + quads.size()) {}

  [[nodiscard]] std::vector<Point> const& points() const { return points_; }
  [[nodiscard]] std::vector<HierarchyCell> const& cells() const { return tree_.cells(); }
  [[nodiscard]] HierarchyCell const& cell(Index c) const { return tree_[c]; }
  [[nodiscard]] bool is_leaf(Index c) const { return tree_.is_leaf(c); }
  [[nodiscard]] std::size_t leaf_count() const { return leaf_count_; }

  /// The cells that are not refined, ascending.
  [[nodiscard]] std::vector<Index> leaves() const {
    std::vector<Index> found;
    found.reserve(leaf_count_);
    for (Index c = 0; c < size(cells()); ++c)
      if (is_leaf(c)) found.push_back(c);
    return found;
  }

  /// Refines the marked leaves and, before each, the leaves that are coarser across one of its
  /// edges, and so on. The result depends on the set of marked leaves, not on order or repetition;
  /// the cost is in proportion to the cells refined. Throws Error for a cell that is out of range
  /// or no leaf, and where a limit would be exceeded; the hierarchy is then as it was.
  Refinement refine(std::span<Index const> marked, RefinementLimits const& limits = {}) {
    std::vector<Index> wanted;
    for (Index const c : marked) {
      if (c < 0 || c >= size(cells()))
        throw Error("Hierarchy: cannot refine cell ", c, ": cells go from 0 to ", size(cells()) - 1,
                    "; mark leaves only");
      if (!is_leaf(c))
        throw Error("Hierarchy: cannot refine cell ", c, " again; mark its children, from cell ",
                    cell(c).first_child, " on, or theirs");
      if (cell(c).level < limits.max_level) wanted.push_back(c);
    }
    std::ranges::sort(wanted);
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());

    Refinement done{.parents = tree_.closure(std::move(wanted)), .new_nodes = {}};
    make_room(done, limits);
    // Nothing throws from here on.
    for (Index const c : done.parents) tree_.split(c, done.new_nodes);
    for (NewNode const& n : done.new_nodes) points_.push_back(mean_of_parents(n));
    leaf_count_ += 3 * done.parents.size();
    return done;
  }

  /// Every hanging node, ascending, with its free masters. Weights are positive and sum to one;
  /// they make the displacement linear along each side of each leaf, and continuous.
  [[nodiscard]] std::vector<Slave> slaves() const {
    std::vector<Slave> hanging;
    for (auto const& [nodes, cells, parent, middle, half] : tree_.edges())
      if (middle >= 0 && cells[1] >= 0 && (is_leaf(cells[0]) || is_leaf(cells[1])))
        hanging.push_back({middle, {{nodes[0], 0.5}, {nodes[1], 0.5}}});
    // The ends of an edge are older than its middle: ascending order has masters first.
    std::ranges::sort(hanging, {}, &Slave::node);
    return compose(std::move(hanging));
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("points", r.points_...);
    visit("cells", r.tree_...);
    visit("number of leaves", r.leaf_count_...);
  }

 private:
  static constexpr std::size_t most_ = std::numeric_limits<Index>::max();

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  static std::vector<HierarchyCell> checked_cells(std::span<Point const> points,
                                                  std::span<std::array<Index, 3> const> triangles,
                                                  std::span<std::array<Index, 4> const> quads) {
    auto const count = triangles.size() + quads.size();
    if (std::max(points.size(), 4 * count) > most_)
      throw Error(
          "Hierarchy: the mesh has more nodes or edges than Index can number; give a coarser one");
    std::vector<HierarchyCell> cells;
    cells.reserve(count);
    for (auto const& t : triangles) cells.push_back({.sides = 3, .nodes = {t[0], t[1], t[2], -1}});
    for (auto const& q : quads) cells.push_back({.sides = 4, .nodes = q});
    for (Index c = 0; c < size(cells); ++c) check_shape(c, cells[at(c)], points);
    return cells;
  }

  static void check_shape(Index c, HierarchyCell const& cell, std::span<Point const> points) {
    auto const k = at(cell.sides);
    for (Index const n : std::span(cell.nodes).first(k))
      if (n < 0 || n >= size(points))
        throw Error("Hierarchy: cell ", c, " has the node ", n, ", but nodes go from 0 to ",
                    size(points) - 1, "; mend its node numbers");
    for (std::size_t i = 0; i < k; ++i) {
      auto const [x, y] = points[at(cell.nodes[i])];
      auto const [next_x, next_y] = points[at(cell.nodes[(i + 1) % k])];
      auto const [last_x, last_y] = points[at(cell.nodes[(i + k - 1) % k])];
      double const a = next_x - x, b = next_y - y, p = last_x - x, q = last_y - y;
      // A sine below 1e-12 is no angle but rounding. The comparison is false for NaN and infinity.
      if (!(a * q - b * p > 1e-12 * std::hypot(a, b) * std::hypot(p, q)))
        throw Error("Hierarchy: cell ", c, " is inverted, degenerate or not finite at its node ",
                    cell.nodes[i], " ", points[at(cell.nodes[i])],
                    "; cells must be strictly convex and counter-clockwise");
    }
  }

  void make_room(Refinement& plan, RefinementLimits const& limits) {
    auto const count = plan.parents.size();
    if (count == 0) return;
    auto const nodes = tree_.count_new_nodes(plan.parents);
    auto const check = [&](char const* what, std::size_t needed, std::size_t limit) {
      if (needed > limit)
        throw Error("Hierarchy: to refine ", count, " cells, coarser neighbours included, takes ",
                    needed, " ", what, " in all, and the limit is ", limit,
                    "; mark fewer cells or raise the limit");
    };
    check("nodes", points_.size() + nodes, std::min(limits.nodes, most_));
    check("leaves", leaf_count_ + 3 * count, limits.leaves);
    check("cells", cells().size() + 4 * count, most_);
    check("edges", tree_.edges().size() + CellTree::most_new_edges * count, most_);
    plan.new_nodes.reserve(nodes);
    auto const needed = points_.size() + nodes;
    if (needed > points_.capacity()) points_.reserve(std::max(needed, 2 * points_.size()));
    tree_.make_room(count);
  }

  Point mean_of_parents(NewNode const& n) const {
    Point sum{};
    for (Index const parent : std::span(n.parents).first(at(n.count)))
      for (std::size_t d = 0; d < 2; ++d) sum[d] += points_[at(parent)][d];
    return {sum[0] / n.count, sum[1] / n.count};
  }

  std::vector<Point> points_;
  CellTree tree_;
  std::size_t leaf_count_ = 0;
};

}  // namespace pliant
