#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/paged_list.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/tree_lists.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant {

/// The cells, edges and sides of a CellTree in a backend's memory, where they are refined. What changed can be taken back
/// until it is kept.
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

  TreeOn(B const& backend, TreeLists const& lists, CellsAtEdges const& at_edges)
      : backend_(backend),
        cells_(backend, lists.cells),
        edges_(backend, lists.edges),
        sides_(backend, lists.sides),
        initial_(lists.initial),
        now_{.nodes = lists.nodes, .leaves = lists.linear_leaves + lists.quadratic_leaves},
        kept_(now_),
        has_quadratic_(lists.quadratic_leaves > 0),
        first_at_edge_(upload(backend, at_edges.first())),
        cells_at_edge_(upload(backend, at_edges.cells())) {}

  [[nodiscard]] TreeView view() const { return {cells_.pages(), edges_.pages(), sides_.pages()}; }
  [[nodiscard]] TreeSizes sizes() const {
    return {size(cells_), size(edges_), size(sides_), now_.nodes};
  }
  [[nodiscard]] Index leaves() const { return now_.leaves; }
  /// How many bytes its lists take.
  [[nodiscard]] std::size_t bytes() const {
    return cells_.bytes() + edges_.bytes() + sides_.bytes();
  }
  /// Copies of the lists on the host.
  [[nodiscard]] std::vector<TreeCell> cells() { return cells_.download(backend_); }
  [[nodiscard]] std::vector<TreeEdge> edges() { return edges_.download(backend_); }
  [[nodiscard]] std::vector<TreeSide> sides() { return sides_.download(backend_); }

  /// Refines marked leaves below the limit of levels and, before each, the leaves that are coarser across one of its edges or
  /// sides, and so on. `marked`: in the backend's memory; cells may be marked several times, and what is no leaf is left
  /// alone. Throws Error where a limit would be exceeded; the tree is then as it was.
  Refined refine(Index const* marked, Index count, RefinementLimits const& limits = {}) {
    Index const n = close(marked, count, limits.max_level);
    if (n == 0) return {};
    first_new_ = now_.nodes;
    need(leaves_, n);
    need(parts_, n);
    backend_.for_each(n, detail::ListLeaves{list_.data(), leaves_.data()});
    own_pages(n);
    auto const planned = division();
    backend_.for_each(n, detail::ClaimShared{planned});
    backend_.for_each(n, detail::FindParts{planned});
    auto const totals = number_parts(n);
    check(n, totals, limits);
    edges_.extend(backend_, at(totals[1]));
    sides_.extend(backend_, at(totals[2]));
    cells_.extend(backend_, at(totals[3]));
    need(made_, totals[0]);
    auto const dividing = division();
    backend_.for_each(n, detail::MakeOnEdges{dividing});
    backend_.for_each(n, detail::MakeOnSides{dividing});
    backend_.for_each(n, detail::MakeChildren{dividing});
    backend_.for_each(n, detail::CountUses{dividing});
    now_.nodes += totals[0];
    now_.leaves += totals[3] - n;
    if (has_quadratic_) make_quadratic(n, limits);
    return {n, now_.nodes - first_new_, leaves_.data(), made_.data(), parts_.data()};
  }

  /// Keeps what changed since the last time.
  void keep() {
    cells_.keep();
    edges_.keep();
    sides_.keep();
    kept_ = now_;
  }
  /// The tree is what it was when it was kept the last time.
  void take_back() {
    cells_.take_back(backend_);
    edges_.take_back(backend_);
    sides_.take_back(backend_);
    now_ = kept_;
  }

 private:
  struct Counts {
    Index nodes = 0, leaves = 0;
  };

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }
  void need(auto& array, Index count) { detail::grow(backend_, array, at(count)); }

  /// The leaves that are divided, as loops see them now.
  [[nodiscard]] detail::DivisionView division() {
    return {view(), leaves_.data(), parts_.data(), first_new_, made_.data()};
  }
  /// Numbers that loops counted.
  template <std::size_t N>
  std::array<Index, N> counted() {
    std::array<Index, N> counts;
    counters_.download(counts);
    return counts;
  }

  /// An entry of an array of numbers.
  Index entry(Array<Index> const& numbers, Index i) {
    backend_.for_each(1, detail::CopyValue<Index>{numbers.data() + i, counters_.data()});
    return counted<1>()[0];
  }

  /// Lists the marked leaves and those to be refined before them, in the order in which they are. Returns how many.
  Index close(Index const* marked, Index count, int max_level) {
    if (stamps_.size() < cells_.size())
      stamps_ = zeros<Index>(backend_, cells_.size() + cells_.size() / 2), stamp_ = 0;
    need(list_, size(cells_));
    counters_ = zeros<Index>(backend_, 4);
    detail::ListOnce const once{stamps_.data(), ++stamp_, list_.data(), counters_.data()};
    backend_.for_each(count, detail::ListMarked{view(), marked, max_level, once});
    Index n = counted<1>()[0], from = 0;
    detail::CellsAtEdgesView const at_edges{view(), initial_.edges, first_at_edge_.data(),
                                            cells_at_edge_.data()};
    while (size(cells_) > initial_.cells && from < n) {  // some may have coarser neighbours
      backend_.for_each(n - from, detail::ListCoarser{at_edges, from, once});
      from = n;
      n = counted<1>()[0];
    }
    need(keys_, n);
    backend_.for_each(n, detail::LevelKeys{view(), list_.data(), keys_.data()});
    constexpr int bits_of_cell = 32, bits_of_level = 6;
    backend_.sort(n, keys_.data(), list_.data(), bits_of_cell + bits_of_level);
    return n;
  }
  /// Makes the pages the tree's own that a division of leaves edits.
  void own_pages(Index n) {
    std::array const counts{cells_.page_count(), edges_.page_count(), sides_.page_count()};
    auto touched = zeros<std::uint8_t>(backend_, counts[0] + counts[1] + counts[2]);
    auto* const first = touched.data();
    backend_.for_each(
        n,
        detail::MarkPages{division(), {first, first + counts[0], first + counts[0] + counts[1]}});
    auto const bytes = download<std::uint8_t>(touched);
    auto const of = [&](std::size_t from, std::size_t count) {
      return std::span(bytes).subspan(from, count);
    };
    cells_.change(backend_, of(0, counts[0]), 0);
    edges_.change(backend_, of(counts[0], counts[1]), 0);
    sides_.change(backend_, of(counts[0] + counts[1], counts[2]), 0);
  }
  /// Numbers what leaves make; returns how many nodes, edges, sides and cells that are.
  std::array<Index, 4> number_parts(Index n) {
    auto* const parts = parts_.data();
    for (auto& before : before_) need(before, n + 1);
    backend_.scan(n, detail::CountOf<&detail::LeafParts::nodes>{parts}, before_[0].data());
    backend_.scan(n, detail::CountOf<&detail::LeafParts::edges>{parts}, before_[1].data());
    backend_.scan(n, detail::CountOf<&detail::LeafParts::sides>{parts}, before_[2].data());
    backend_.scan(n, detail::CountOf<&detail::LeafParts::cells>{parts}, before_[3].data());
    backend_.for_each(n + 1, detail::NumberParts{parts,
                                                 {before_[0].data(), before_[1].data(),
                                                  before_[2].data(), before_[3].data()},
                                                 sizes(),
                                                 n,
                                                 counters_.data()});
    return counted<4>();
  }
  /// Throws Error, with the tree as it was, where there would be more than a limit.
  void check(Index n, std::array<Index, 4> const& more, RefinementLimits const& limits) {
    auto const check_one = [&](char const* what, Index now, Index of_these, std::size_t limit) {
      auto const in_all = at(now) + at(of_these);
      if (in_all <= std::min(limit, at(std::numeric_limits<Index>::max()))) return;
      take_back();
      throw Error("refine: to refine ", n, " cells, coarser neighbours included, takes ", in_all,
                  " ", what, " in all, and the limit is ", limit,
                  "; mark fewer cells or raise the limit");
    };
    constexpr auto most = static_cast<std::size_t>(std::numeric_limits<Index>::max());
    check_one("nodes", now_.nodes, more[0], limits.nodes);
    check_one("leaves", now_.leaves - n, more[3], limits.leaves);
    check_one("cells", size(cells_), more[3], most);
    check_one("edges", size(edges_), more[1], most);
    check_one("sides", size(sides_), more[2], most);
  }
  /// Makes the nodes that children's elements have between their corners.
  void make_quadratic(Index n, RefinementLimits const& limits) {
    detail::CountQuadratic const quadratic{division()};
    backend_.scan(n, quadratic, before_[0].data());
    need(children_, n * static_cast<Index>(RefinementPattern::most_children));
    backend_.for_each(n, detail::ListQuadratic{quadratic, before_[0].data(), children_.data()});
    Index const count = entry(before_[0], n);
    need(children_made_, count);
    need(before_[1], count + 1);
    detail::ElementNodesView nodes{view(), children_.data(), children_made_.data(),
                                   true,   now_.nodes,       nullptr};
    backend_.for_each(count, detail::ClaimNodes{nodes});
    backend_.for_each(count, detail::FindNodes{nodes});
    backend_.scan(count, detail::CountNodes{children_made_.data()}, before_[1].data());
    Index const more = entry(before_[1], count);
    check(n, {more, 0, 0, 0}, limits);
    Index const known = now_.nodes - first_new_;
    detail::grow_keeping(backend_, made_, at(known), at(known + more));
    nodes.made = made_.data() + known;
    backend_.for_each(count, detail::MakeNodes{nodes, before_[1].data()});
    now_.nodes += more;
  }

  B backend_;
  PagedList<B, TreeCell> cells_;
  PagedList<B, TreeEdge> edges_;
  PagedList<B, TreeSide> sides_;
  TreeSizes initial_;
  Counts now_, kept_;
  Index first_new_ = 0;  // node of the last refinement
  bool has_quadratic_;
  Array<Index> first_at_edge_, cells_at_edge_;  // see CellsAtEdges
  // Of a change.
  Array<Index> stamps_;  // (cells): the change that listed them last
  Index stamp_ = 0;
  Array<Index> list_, counters_;
  Array<std::uint64_t> keys_;
  Array<CellSplit> leaves_;
  Array<detail::LeafParts> parts_;
  std::array<Array<Index>, 4> before_;
  Array<PlacedNode> made_;
  Array<Index> children_;
  Array<detail::CellNodesMade> children_made_;
};

}  // namespace pliant
