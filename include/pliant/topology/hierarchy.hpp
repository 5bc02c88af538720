#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/check_convex.hpp>
#include <pliant/topology/hanging_nodes.hpp>
#include <pliant/topology/nodes_between.hpp>
#include <pliant/topology/refinable.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/shared_list.hpp>
#include <pliant/topology/transfer.hpp>
#include <pliant/topology/tree_facets.hpp>
#include <pliant/topology/tree_queries.hpp>

namespace pliant {

/// The refinement tree of a mesh, plane or solid, of elements of degree one or two, as RefinementPattern divides their cells, into
/// smaller ones or between their corners. Levels differ by one at most across edges and sides; nodes that hang there are slaves
/// of the coarser element's, so that fields are continuous. Refinement appends cells and nodes; coarsening takes away what
/// nothing uses any more, and what stays keeps its order: nodes and cells of the initial mesh keep their numbers for good.
///
///       2            3------+------2
///      /2\           |  3   |  2   |
///     +---+          +------+------+
///    /0\3/1\         |  0   |  1   |
///   0---+---1        0------+------1
template <int Dim>
class Hierarchy {
 public:
  /// Of no cells.
  Hierarchy() = default;
  /// Takes the elements of a mesh, type after type. Throws Error for nodes out of range, points that are not
  /// finite, plane cells that are not strictly convex and counter-clockwise, and cells that overlap.
  template <Refinable... Es>
    requires(Mesh<Es...>::dim == Dim)
  explicit Hierarchy(Mesh<Es...> const& mesh)
      : points_(mesh.nodes),
        tree_(static_cast<Index>(mesh.nodes.size()), detail::layout_of_rows(mesh)) {
    auto const elements = (mesh.template elements<Es>().size() + ...);
    if (std::max(points_.size(), 12 * elements) > most_)
      throw Error(
          "Hierarchy: the mesh has more nodes or edges than Index can number; give a coarser one");
    (add<Es>(mesh.template elements<Es>()), ...);
    tree_.seal();
  }

  /// Of a tree with elements of one degree, and its nodes.
  Hierarchy(SharedList<Point<Dim>> points, CellTree<Dim> tree)
      : points_(std::move(points)), tree_(std::move(tree)) {}

  [[nodiscard]] SharedList<Point<Dim>> const& points() const { return points_; }
  [[nodiscard]] CellTree<Dim> const& tree() const { return tree_; }
  [[nodiscard]] SharedList<TreeCell> const& cells() const { return tree_.cells(); }
  [[nodiscard]] TreeCell const& cell(Index c) const { return tree_[c]; }
  [[nodiscard]] bool is_leaf(Index c) const { return tree_.is_leaf(c); }
  [[nodiscard]] std::size_t leaf_count() const { return tree_.leaf_count(); }

  /// The cells that are not refined, ascending.
  [[nodiscard]] std::vector<Index> leaves() const {
    std::vector<Index> found;
    found.reserve(leaf_count());
    for (Index c = 0; c < size(cells()); ++c)
      if (is_leaf(c)) found.push_back(c);
    return found;
  }

  /// Refines the marked leaves and, before each, the leaves that are coarser across one of its edges or
  /// sides, and so on. The result depends on the set of marked leaves, not on order or repetition. Throws
  /// Error for a cell that is out of range or no leaf, and where a limit would be exceeded; the hierarchy is
  /// then as it was.
  Refinement<Dim> refine(std::span<Index const> marked, RefinementLimits const& limits = {},
                         KnownFacets<Dim> const& known = {}) {
    detail::check_max_level("Hierarchy", limits.max_level);
    std::vector<Index> wanted;
    for (Index const c : marked) {
      check_number("refine", c);
      if (!is_leaf(c))
        throw Error("Hierarchy: cannot refine cell ", c, " again; mark its children, from cell ",
                    cell(c).first_child, " on, or theirs");
      if (cell(c).level < limits.max_level) wanted.push_back(c);
    }
    wanted = detail::each_once(std::move(wanted), cells().size());
    if (wanted.empty()) return {};
    if (std::ranges::any_of(wanted, [&](Index c) { return cell(c).level > 0; }))
      tree_.keep_cells_at_edges();  // some may have coarser neighbours
    Refinement<Dim> done{
        .parents = TreeQueries(tree_).closure(std::move(wanted)), .new_nodes = {}, .facets = {}};
    std::vector<CellSplit> leaves;
    leaves.reserve(done.parents.size());
    for (Index const c : done.parents) leaves.push_back({c, Division::refined});
    auto const whole = TreeFacets(tree_, known).whole_sides_of(done.parents);
    done.new_nodes = divide("refine", leaves, limits);
    done.facets = TreeFacets(tree_).divided(whole);
    return done;
  }

  /// Merges the children of refined cells, all of which are marked. A family stays where one of its children is
  /// not marked or is refined, and where it touches cells two levels finer than the parent, at edges or sides,
  /// before the call. Throws Error for a cell that is out of range or no leaf; the hierarchy is then as it was.
  Coarsening<Dim> coarsen(std::span<Index const> marked) {
    auto const parents = families(marked);
    return merge(parents);
  }
  /// The parents of the families that coarsen would merge, ascending.
  [[nodiscard]] std::vector<Index> families(std::span<Index const> marked) const {
    return families(marked, [](TreeCell const& parent) { return !parent.is_split(); });
  }
  /// The cells that were split into the marked leaves, all of which have corners only, ascending.
  [[nodiscard]] std::vector<Index> split_cells(std::span<Index const> marked) const {
    return families(marked, [](TreeCell const& parent) { return parent.is_split(); });
  }
  /// Merges what `families` and `split_cells` gave, and takes other leaves the nodes between their corners.
  Coarsening<Dim> merge(std::vector<Index> const& parents, std::vector<Index> const& lowered = {},
                        KnownFacets<Dim> const& known = {}) {
    Coarsening<Dim> done{.parents = parents, .renumbered = {}, .gone = {}, .facets = {}};
    if (parents.empty() && lowered.empty()) return done;
    tree_.take_degree_of_children(parents);
    auto refined = parents;
    std::erase_if(refined, [&](Index c) { return cell(c).is_split(); });
    TreeFacets const facets(tree_, known);
    done.facets = facets.divided(facets.sides_of_no_other(refined));
    auto const inside = detail::nodes_between(tree_, lowered, parents);
    done.renumbered = tree_.merge(parents, lowered);
    for (NewNode const& node : inside)
      if (done.renumbered.nodes[node.node] < 0) done.gone.push_back(node);
    for (Index& c : done.parents) c = done.renumbered.cells[c];
    keep_points(done.renumbered.nodes);
    return done;
  }

  /// Gives leaves that have corners only the nodes of another degree. Throws Error where the limit of nodes would be
  /// exceeded; the hierarchy is then as it was.
  AddedNodes raise(std::vector<CellConversion> const& conversions,
                   RefinementLimits const& limits = {}) {
    auto const nodes = points_.size() + TreeQueries(tree_).count_new_nodes(conversions);
    if (auto const limit = std::min(limits.nodes, most_); nodes > limit)
      detail::refuse_raising(conversions.size(), nodes, limit);
    std::vector<PlacedNode> made;
    tree_.raise(conversions, made);
    return {add_points(made)};
  }
  /// Puts cells of another shape in the place of leaves that have corners only. They are neither coarser nor finer, and
  /// no edge or side is divided. Throws Error as refine.
  AddedNodes split(std::vector<CellSplit> const& splits, RefinementLimits const& limits = {}) {
    if (splits.empty()) return {};
    return {divide("split", splits, limits)};
  }
  /// The whole sides of leaves (in the plane, edges), as facets with the nodes that they have now.
  [[nodiscard]] std::vector<DividedFacet<Dim>> whole_facets(
      std::vector<Index> const& leaves) const {
    return TreeFacets(tree_).whole(leaves);
  }

  /// Every hanging node, ascending, with its free masters. Weights sum to one. They make the displacement
  /// on each edge and side of each leaf what its own nodes say, and continuous: there it is of the lowest degree
  /// of the leaves around.
  [[nodiscard]] std::vector<Slave> slaves() const { return detail::slaves_of(slave_rows()); }
  /// The same in compressed rows.
  [[nodiscard]] SlaveRows slave_rows() const { return HangingNodes(tree_).slaves(); }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("points", r.points_...);
    visit("cells", r.tree_...);
  }

 private:
  /// The parents of which all children are marked and can be merged, and of which wanted(cell).
  template <class Wanted>
  [[nodiscard]] std::vector<Index> families(std::span<Index const> marked,
                                            Wanted const& wanted) const {
    std::vector<Index> sorted(marked.begin(), marked.end());
    for (Index const c : sorted) {
      check_number("coarsen", c);
      if (!is_leaf(c))
        throw Error("Hierarchy: cannot merge cell ", c, ", which is divided; mark leaves");
    }
    sorted = detail::each_once(std::move(sorted), cells().size());
    std::vector<Index> parents;
    for (std::size_t i = 0; i < sorted.size();) {
      Index const parent = cell(sorted[i]).parent;
      std::size_t next = i + 1;
      while (next < sorted.size() && cell(sorted[next]).parent == parent) ++next;
      if (parent >= 0 && next - i == at(cell(parent).divided().children) && wanted(cell(parent)))
        parents.push_back(parent);
      i = next;
    }
    std::vector<char> can(parents.size());
    detail::for_each_on_host(size(parents), 512,
                             [&](Index k) { can[at(k)] = tree_.can_be_merged(parents[at(k)]); });
    std::vector<Index> found;
    for (std::size_t k = 0; k < can.size(); ++k)
      if (can[k] != 0) found.push_back(parents[k]);
    std::ranges::sort(found);
    return found;
  }

  static constexpr std::size_t most_ = std::numeric_limits<Index>::max();
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }
  void check_number(char const* verb, Index c) const {
    if (c < 0 || c >= size(cells()))
      throw Error("Hierarchy: cannot ", verb, " cell ", c, ": cells go from 0 to ",
                  size(cells()) - 1, "; mark leaves only");
  }

  template <Element E>
  void add(std::vector<Connectivity<E>> const& elements) {
    Index const first = size(cells());
    detail::for_each_on_host(size(elements), detail::few_elements(E::nodes), [&](Index e) {
      auto const& nodes = elements[at(e)];
      for (Index const n : nodes)
        if (n < 0 || n >= size(points_))
          throw Error("Hierarchy: cell ", first + e, " has the node ", n,
                      ", but nodes go from 0 to ", size(points_) - 1, "; mend its node numbers");
      if constexpr (Dim == 2) detail::check_convex<E>(first + e, nodes, points_);
    });
    tree_.add(kind_of<typename E::cell>, nodes_on_cell<E>, elements);
  }
  /// Divides leaves, and gives the nodes that it takes. Throws Error where that is more than a limit.
  WeightedNodes divide(char const* verb, std::vector<CellSplit> const& leaves,
                       RefinementLimits const& limits) {
    auto plan = tree_.plan_division(leaves);
    auto const check = [&](char const* what, std::size_t in_all, std::size_t limit) {
      if (in_all > limit)
        throw Error(verb, ": to ", verb, " ", leaves.size(),
                    " cells, coarser neighbours included, takes ", in_all, " ", what,
                    " in all, and the limit is ", limit, "; mark fewer cells or raise the limit");
    };
    check("nodes", points_.size() + count_new_nodes(plan, leaves), std::min(limits.nodes, most_));
    check("leaves", leaf_count() + plan.new_cells() - leaves.size(), limits.leaves);
    check("cells", cells().size() + plan.new_cells(), most_);
    check("edges", tree_.edges().size() + plan.new_edges(), most_);
    return add_points(tree_.divide(plan));
  }
  /// Those between the corners of children's elements with them.
  std::size_t count_new_nodes(detail::DivisionPlan const& plan,
                              std::vector<CellSplit> const& leaves) const {
    if (std::ranges::all_of(leaves, [&](CellSplit const& leaf) {
          return cell(leaf.cell).has == CellNodes::corners;
        }))
      return plan.new_nodes();
    std::vector<Index> refined;
    for (auto const& leaf : leaves) refined.push_back(leaf.cell);
    return TreeQueries(tree_).count_new_nodes(refined);
  }

  /// Gives new nodes their points.
  WeightedNodes add_points(std::vector<PlacedNode> const& made) {
    auto const first = points_.size();
    points_.extend(made.size());
    return WeightedNodes::made_on_host(size(made), 1024, [&](Index k, WeightedNodes& nodes) {
      auto const weights = weights_at(made[at(k)]);
      nodes.push_back(made[at(k)].node, weights);
      points_.edit(first + at(k)) = mean_of(weights);
    });
  }
  void keep_points(NumberMap const& renumbered) {
    auto const kept = renumbered.inverse();
    points_.replace_from(at(kept.first()), kept.others().size(),
                         [&](std::size_t k) { return points_[at(kept.others()[k])]; });
  }
  detail::ShapeWeights weights_at(PlacedNode const& node) const {
    return detail::shape_weights<Dim>(cell(node.cell).kind, node.had, tree_.nodes_of(node.cell),
                                      node.place);
  }
  Point<Dim> mean_of(detail::ShapeWeights const& parents) const {
    using S = Uncontracted;  // as devices do: see FillNewNodes
    // Equal weights as a sum and a division: the mean does not depend on how the sum is rounded.
    Point<Dim> sum{};
    auto const as_first = [&](auto const& parent) { return parent.second == parents[0].second; };
    bool const equal = std::ranges::all_of(parents, as_first);
    for (auto const& [parent, weight] : parents)
      for (std::size_t d = 0; d < Dim; ++d)
        sum[d] = (S(sum[d]) + S(equal ? 1.0 : weight) * S(points_[at(parent)][d])).value;
    if (equal)
      for (double& x : sum) x /= static_cast<double>(parents.size());
    return sum;
  }

  SharedList<Point<Dim>> points_;
  CellTree<Dim> tree_;
};

}  // namespace pliant
