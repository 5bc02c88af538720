#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/cell_set.hpp>
#include <pliant/topology/element_nodes_on.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/stamps.hpp>
#include <pliant/topology/tree_closure.hpp>
#include <pliant/topology/tree_coarsening.hpp>
#include <pliant/topology/tree_conversion.hpp>
#include <pliant/topology/tree_division.hpp>
#include <pliant/topology/tree_lists.hpp>
#include <pliant/topology/tree_passes.hpp>
#include <pliant/topology/tree_splitting.hpp>

namespace pliant {

/// The cells, edges and sides of a CellTree in a backend's memory, where they are refined and coarsened. What changed can be
/// taken back until it is kept.
template <Backend B>
class TreeOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// What a refinement made, in the backend's memory, until the next one.
  struct Refined {
    Index leaves = 0;                          ///< how many cells were refined
    Index new_nodes = 0;                       ///< and nodes made
    CellSplit const* cells = nullptr;          ///< (leaves): coarser ones first, then ascending
    PlacedNode const* nodes = nullptr;         ///< (new_nodes), in the order of their numbers
    detail::LeafParts const* parts = nullptr;  ///< (leaves): what each made
  };

  /// The same of leaves that were split, ascending.
  struct Split : Refined {};

  /// Where there are up to so many cells behind the initial mesh's, beside eight for each that is marked, coarsening moves all that
  /// came later, which takes less than to find out what may stay where it is.
  Index few = TreeView::few;

  TreeOn(B const& backend, TreeLists const& lists, CellsAtEdges const& at_edges)
      : backend_(backend),
        lists_(backend, lists),
        initial_(lists.initial),
        now_{.nodes = lists.nodes,
             .leaves = lists.linear_leaves + lists.quadratic_leaves,
             .has_quadratic = lists.quadratic_leaves > 0,
             .mixes_degrees = (lists.quadratic_leaves > 0 && lists.linear_leaves > 0) ||
                              !lists.converted.empty()},
        kept_(now_),
        closure_(backend, at_edges),
        division_(backend) {}

  [[nodiscard]] TreeView view() const { return lists_.view(); }
  [[nodiscard]] TreeSizes sizes() const {
    return {size(lists_.cells), size(lists_.edges), size(lists_.sides), now_.nodes};
  }
  /// Of the initial mesh, of which coarsening takes nothing away.
  [[nodiscard]] TreeSizes const& initial() const { return initial_; }
  [[nodiscard]] Index leaves() const { return now_.leaves; }
  /// Whether some leaves may have corners only beside others, or cells another degree than in the initial mesh.
  [[nodiscard]] bool mixes_degrees() const { return now_.mixes_degrees; }
  /// Whether all of its leaves are known to have corners only.
  [[nodiscard]] bool is_linear() const { return !now_.has_quadratic; }
  /// How many bytes its lists take.
  [[nodiscard]] std::size_t bytes() const { return lists_.bytes(); }
  /// Copies of the lists on the host.
  [[nodiscard]] std::vector<TreeCell> cells() { return lists_.cells.download(backend_); }
  [[nodiscard]] std::vector<TreeEdge> edges() { return lists_.edges.download(backend_); }
  [[nodiscard]] std::vector<TreeSide> sides() { return lists_.sides.download(backend_); }
  [[nodiscard]] std::vector<RowEntry> rows() { return lists_.rows.download(backend_); }

  /// The tree on the host. `like`: what it was when it was made or began to note
  /// changes, or has been since; what has not changed is shared with that. `leaves`: of it, by the kind.
  [[nodiscard]] TreeLists lists(TreeLists const& like, std::vector<CellSet> const& leaves) {
    TreeLists lists{.cells = lists_.cells.download(backend_, like.cells),
                    .edges = lists_.edges.download(backend_, like.edges),
                    .sides = lists_.sides.download(backend_, like.sides),
                    .rows = lists_.rows.download(backend_, like.rows),
                    .layout = lists_.layout,
                    .initial = initial_,
                    .nodes = now_.nodes};
    (now_.has_quadratic ? lists.quadratic_leaves : lists.linear_leaves) = now_.leaves;
    if (now_.mixes_degrees) lists.find_degrees();
    for (Index c = 0; c < sizes().cells; ++c)
      if (std::ranges::none_of(leaves, [&](CellSet const& own) { return own.contains(c); }))
        lists.divided.push_back(c);
    return lists;
  }
  /// Notes what changes from now on, for that.
  void begin_noting() { lists_.begin_noting(backend_); }

  /// Refines marked leaves below the limit of levels and, before each, the leaves that are coarser across one of its edges or
  /// sides, and so on. `marked`: in the backend's memory; cells may be marked several times, and what is no leaf is left
  /// alone. Throws Error where a limit would be exceeded; the tree is then what it was when it was kept.
  Refined refine(Index const* marked, Index count, RefinementLimits const& limits = {}) {
    detail::check_max_level("refine", limits.max_level);
    Index const n = closure_(backend_, view(), size(lists_.cells), initial_, stamps_, marked, count,
                             limits.max_level);
    if (n == 0) return {};
    need(keys_, n);
    CellSplit* const leaves = division_.begin(n);
    Index* const list = closure_.list();
    lists_.own(backend_, [&](detail::PageMarks const& marks, auto const& tell) {
      int const bits_of_cell = detail::key_bits(size(lists_.cells));
      detail::in_turn(
          backend_,
          detail::LoopStep{n, detail::LevelKeys{view(), list, keys_.data(), bits_of_cell}},
          detail::SortStep{n, keys_.data(), list, bits_of_cell + detail::key_bits(most_levels + 1)},
          detail::LoopStep{n, detail::ListLeaves{list, leaves}}, division_.marking(marks), tell);
    });
    Index const first_new_node = now_.nodes;
    divide("refine", limits);
    if (now_.has_quadratic) make_element_nodes(first_new_node, limits);
    return {n, now_.nodes - first_new_node, division_.leaves(), division_.made(),
            division_.parts()};
  }

  /// Puts cells of another shape in the place of marked leaves that have corners only, between their corners; a pyramid is split
  /// with the one on the other side of its base, or not at all. They are neither coarser nor finer. Throws Error as refine.
  template <int Dim>
  Split split(MarkedToSplit const& marked, NodesAtRest<Dim> const& nodes,
              RefinementLimits const& limits = {}) {
    Index const cells = size(lists_.cells),
                n = splitting_(backend_, view(), cells, stamps_, marked);
    if (n == 0) return {};
    CellSplit* const leaves = division_.begin(n);
    lists_.own(backend_, [&](detail::PageMarks const& marks, auto const& tell) {
      splitting_.choose(backend_, view(), cells, n, nodes, leaves);
      detail::in_turn(backend_, division_.marking(marks), tell);
    });
    divide("split", limits);
    return {{n, division_.new_nodes(), division_.leaves(), division_.made(), division_.parts()}};
  }

  /// Merges the children of refined cells, all of which are marked, as Hierarchy::coarsen does: a family stays where one of its
  /// children is not marked, is divided or has another degree than the others, and where it touches cells two levels finer
  /// than the parent. Parents take the degree of their children. Cells, edges, sides and nodes that nothing uses any more
  /// go, but for those of the initial mesh, and the others keep their order and move up. `marked`: as for `refine`. Throws
  /// Error where memory runs out; what was kept is there then after take_back.
  Coarsened coarsen(Index const* marked, Index count) {
    return counted(
        coarsening_(backend_, lists_, initial_, sizes(), degrees(), few, stamps_, marked, count));
  }

  /// The same of cells that were split into leaves with corners only, all of which are marked; of two pyramids that share a base both
  /// or none.
  Merged merge(Index const* marked, Index count) {
    auto const done = counted(coarsening_(backend_, lists_, initial_, sizes(), degrees(), few,
                                          stamps_, marked, count, true));
    return {done, coarsening_.children()};
  }

  /// Marked leaves and rings of leaves around them, each of which shares an edge, whole or in part, with one of the ring before: how
  /// many, and these in the backend's memory, each once, until the next change or call. `marked`: as for `refine`.
  std::pair<Index, Index const*> with_neighbours(Index const* marked, Index count, int rings) {
    Index const n = closure_.neighbours(backend_, view(), size(lists_.cells), initial_, stamps_,
                                        marked, count, rings);
    return {n, closure_.list()};
  }
  /// Gives marked leaves that have corners only the nodes of their kind. `marked`: as for `refine`; negative ones are none. Throws
  /// Error where there would be too many nodes; the tree is then what it was when it was kept.
  Raised raise(Index const* marked, Index count, NodesOfKinds const& to,
               RefinementLimits const& limits = {}) {
    Index const n =
        conversion_.convert(backend_, lists_, size(lists_.cells), stamps_, to, marked, count);
    if (n == 0) return {};
    Index const more = element_nodes_.find(backend_, view(), conversion_.cells(), n);
    if (auto const in_all = at(now_.nodes) + at(more), limit = std::min(limits.nodes, most);
        in_all > limit) {
      take_back();
      detail::refuse_raising(at(n), in_all, limit);
    }
    need(made_, more);
    element_nodes_.make(backend_, now_.nodes, made_.data());
    now_.mixes_degrees = now_.has_quadratic = true;
    now_.nodes += more;
    return {n, conversion_.cells(), more, made_.data()};
  }
  /// Takes marked leaves the nodes between their corners. Those that no other leaf has go, but for those of the initial mesh, and
  /// the others keep their order and move up. `marked`: as for `raise`. Throws Error as coarsen.
  Lowered lower(Index const* marked, Index count) {
    Index const n = conversion_.convert(backend_, lists_, size(lists_.cells), stamps_,
                                        {.raises = false}, marked, count);
    if (n == 0) return {{.staying = initial_, .before = sizes(), .now = sizes()}};
    now_.mixes_degrees = true;
    auto const done =
        coarsening_.lower(backend_, lists_, initial_, sizes(), conversion_.cells(), n);
    now_.nodes = done.now.nodes;
    return done;
  }

  /// Keeps what changed since the last time.
  void keep() {
    lists_.keep();
    coarsening_.keep();
    kept_ = now_;
  }
  /// The tree is what it was when it was kept the last time.
  void take_back() {
    lists_.take_back(backend_);
    coarsening_.take_back();
    now_ = kept_;
  }

 private:
  struct Counts {
    Index nodes = 0, leaves = 0;
    bool has_quadratic = false, mixes_degrees = false;
  };

  static constexpr std::size_t most = std::numeric_limits<Index>::max();
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }
  void need(auto& array, Index count) { detail::grow(backend_, array, at(count)); }

  [[nodiscard]] detail::Degrees degrees() const {
    using detail::Degrees;
    return now_.mixes_degrees ? Degrees::several : now_.has_quadratic ? Degrees::two : Degrees::one;
  }
  /// Throws Error, with the tree as it was, where there would be more than a limit.
  void check(char const* verb, Index n, std::array<Index, 4> const& more,
             RefinementLimits const& limits) {
    auto const check_one = [&](char const* what, Index now, Index of_these, std::size_t limit) {
      if (auto const in_all = at(now) + at(of_these); in_all > std::min(limit, most)) {
        take_back();
        detail::refuse_division(verb, n, what, in_all, limit);
      }
    };
    check_one("nodes", now_.nodes, more[0], limits.nodes);
    check_one("leaves", now_.leaves - n, more[3], limits.leaves);
    check_one("cells", size(lists_.cells), more[3], most);
    check_one("edges", size(lists_.edges), more[1], most);
    check_one("sides", size(lists_.sides), more[2], most);
    check_one("edges of cells", 0, n, most / detail::MakeOnEdges::each);
  }
  /// Notes how many nodes and leaves are left.
  Coarsened counted(Coarsened const& done) {
    now_.nodes = done.now.nodes;
    now_.leaves += done.merged - (done.before.cells - done.now.cells);
    return done;
  }
  /// Divides the leaves that were listed.
  void divide(char const* verb, RefinementLimits const& limits) {
    Index const n = division_.count();
    division_.number(view(), sizes(),
                     [&](std::array<Index, 4> const& more) { check(verb, n, more, limits); });
    coarsening_.note_division(sizes());
    division_.make(lists_);
    now_.nodes += division_.new_nodes();
    now_.leaves += division_.new_cells() - n;
  }
  /// Makes the nodes that children's elements have between their corners, behind those of the division.
  void make_element_nodes(Index first_new_node, RefinementLimits const& limits) {
    Index const more = division_.find_element_nodes(view());
    check("refine", division_.count(), {more, 0, 0, 0}, limits);
    division_.make_element_nodes(now_.nodes - first_new_node, more);
    now_.nodes += more;
  }

  B backend_;
  detail::PagedTree<B> lists_;
  TreeSizes initial_;
  Counts now_, kept_;
  // Of a change.
  detail::Stamps<B> stamps_;  // by cell
  detail::TreeClosure<B> closure_;
  detail::TreeSplitting<B> splitting_;
  detail::TreeDivision<B> division_;
  Array<std::uint64_t> keys_;
  Array<PlacedNode> made_;  // of elements that are raised
  detail::ElementNodesOn<B> element_nodes_;
  detail::TreeCoarsening<B> coarsening_;
  detail::TreeConversion<B> conversion_;
};

}  // namespace pliant
