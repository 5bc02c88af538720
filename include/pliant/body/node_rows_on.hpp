#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/body/leaf_order_passes.hpp>
#include <pliant/body/node_row_passes.hpp>
#include <pliant/body/node_rows.hpp>

namespace pliant {

/// NodeRows in a backend's memory. New nodes get rows near those of others that are made for near leaves.
template <Backend B>
class NodeRowsOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// Of a first mesh, or of any other.
  NodeRowsOn(B const& backend, NodeRows const& rows)
      : backend_(backend), nodes_(static_cast<Index>(rows.of_node.size())), counts_(backend, 3) {
    auto padded = rows;
    pages_ = (rows.count() + NodeRows::page - 1) / NodeRows::page;
    padded.node.resize(static_cast<std::size_t>(pages_ * NodeRows::page), -1);
    padded.region.resize(static_cast<std::size_t>(pages_), -2);
    of_node_ = upload(backend, padded.of_node);
    node_ = upload(backend, padded.node);
    region_ = upload(backend, padded.region);
    for (Index page = 0; page < pages_; ++page) {
      auto const first = padded.node.begin() + NodeRows::page * page;
      most_partial_ += std::find(first, first + NodeRows::page, -1) != first + NodeRows::page;
    }
  }

  [[nodiscard]] Index nodes() const { return nodes_; }
  /// How many rows there are.
  [[nodiscard]] Index count() const { return pages_ * NodeRows::page; }
  /// By the user's number of a node.
  [[nodiscard]] Index const* of_node() const { return of_node_.data(); }
  /// The user's numbers of nodes by the row; −1: the row is free.
  [[nodiscard]] Index const* node() const { return node_.data(); }
  /// The rows that were a node's before the last change and are free now: (freed_count()), in the backend's memory.
  [[nodiscard]] Index const* freed() const { return freed_.data(); }
  [[nodiscard]] Index freed_count() const { return freed_count_; }
  /// Copies of the lists, which later changes do not touch.
  struct Lists {
    Array<Index> of_node, node, region;

    /// On the host.
    [[nodiscard]] NodeRows download_all() const {
      return {download<Index>(of_node), download<Index>(node), download<Index>(region)};
    }
  };
  [[nodiscard]] Lists lists(detail::ArrayCopies<B>& copies) const {
    auto const all = [&](Array<Index> const& array, Index count) {
      return copies.copy_of(array.data(), at(count), at(count));
    };
    return {all(of_node_, nodes_), all(node_, count()), all(region_, pages_)};
  }
  /// A copy on the host.
  [[nodiscard]] NodeRows download_all() const {
    detail::ArrayCopies<B> copies(backend_);
    auto const all = lists(copies);
    copies.make();
    return all.download_all();
  }

  /// Gives rows to the nodes that a change made, a TreeOn::Refined or Raised; `order`: of the leaves after it.
  template <class Made>
  void extend(TreeOn<B> const& tree, LeafOrderOn<B> const& order, Made const& made) {
    Index const n = made.new_nodes;
    freed_count_ = 0;
    if (n == 0) return;
    need(keys_, n);
    need(order_, n);
    need(found_, n);
    need(partial_, pages_);
    need(free_pages_, pages_);
    backend_.select(pages_, detail::FreesPage{node_.data(), region_.data()}, free_pages_.data(),
                    counts_.data() + 2);
    Index* const listed = counter_.data();
    backend_.select(pages_, detail::HasFreeRows{node_.data(), region_.data()}, partial_.data(),
                    listed);
    // So many at most: how many there are is not waited for.
    Index const partial = std::min(most_partial_, pages_);
    need(page_keys_, partial);
    need(free_before_, partial + 1);
    Index const regions = (order.blocks() + blocks_of_region - 1) / blocks_of_region;
    detail::NewRows const rows{n,
                               partial,
                               keys_.data(),
                               page_keys_.data(),
                               free_before_.data(),
                               order.first_of_block(),
                               order.blocks(),
                               blocks_of_region};
    need(before_, regions + 1);
    using detail::LoopStep, detail::ScanStep, detail::SortStep;
    detail::in_turn(
        backend_,
        LoopStep{n, detail::KeysOfNodes{tree.view(), made.nodes, order.places(), keys_.data(),
                                        order_.data()}},
        SortStep{n, keys_.data(), order_.data(), detail::key_bits(tree.leaves())},
        LoopStep{partial, detail::KeysOfPages{region_.data(), partial_.data(), listed, regions,
                                              page_keys_.data()}},
        SortStep{partial, page_keys_.data(), partial_.data(), detail::key_bits(regions + 1)},
        ScanStep{partial, detail::FreeRowsIn{node_.data(), partial_.data(), listed},
                 free_before_.data()},
        ScanStep{regions, detail::PagesNeeded{rows}, before_.data()},
        LoopStep{1, detail::TellBoth{before_.data() + regions, listed, counts_.data()}});
    backend_.synchronize();
    auto const [more, partial_before, free] = counts_.template first<3>();
    // A region has one page at most that it fills partly now.
    most_partial_ = partial_before + std::min(n, regions);
    Index const in_all = std::max(pages_, pages_ + more - free);
    detail::grow_keeping(backend_, node_, at(count()), at(in_all * NodeRows::page));
    detail::grow_keeping(backend_, region_, at(pages_), at(in_all));
    detail::grow_keeping(backend_, of_node_, at(nodes_), at(nodes_ + n));
    detail::PageAt const page_at{free_pages_.data(), free, pages_};
    detail::in_turn(backend_,
                    LoopStep{more, detail::TakePages{page_at, before_.data(), regions,
                                                     region_.data(), node_.data()}},
                    LoopStep{n, detail::FindRows{rows, node_.data(), partial_.data(), page_at,
                                                 before_.data(), found_.data()}},
                    LoopStep{n, detail::TakeFoundRows{found_.data(), order_.data(), made.nodes,
                                                      of_node_.data(), node_.data()}});
    pages_ = in_all;
    nodes_ += n;
  }
  /// Frees the rows of nodes that a coarsening took away; the others keep theirs. There are as many rows as before: pages
  /// without nodes wait for a refinement, those at the end too. Waits for nothing.
  void coarsen(Coarsened const& done) {
    Index const staying = done.now.nodes - done.staying.nodes;
    freed_count_ = done.before.nodes - done.now.nodes;
    if (freed_count_ == 0) return;
    Index const n = done.before.nodes - done.staying.nodes;
    Index* const of_node = of_node_.data() + done.staying.nodes;
    need(freed_, freed_count_);
    need(found_, staying);
    need(before_, n + 1);
    using detail::LoopStep, detail::ScanStep;
    detail::GoesAway const goes{done.nodes};
    detail::in_turn(backend_, ScanStep{n, goes, before_.data()},
                    LoopStep{n, detail::ListFreed{goes, before_.data(), of_node, freed_.data()}},
                    LoopStep{n, detail::MoveRows{{done.staying.nodes, done.nodes},
                                                 of_node_.data(),
                                                 node_.data(),
                                                 found_.data()}},
                    LoopStep{staying, detail::CopyValue<Index>{found_.data(), of_node}});
    nodes_ = done.now.nodes;
    most_partial_ += freed_count_;
  }

 private:
  static constexpr Index blocks_of_region = 16;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  void need(auto& array, Index count) { detail::grow(backend_, array, at(count)); }

  B backend_;
  Array<Index> of_node_, node_, region_;
  Index nodes_ = 0, pages_ = 0, freed_count_ = 0;
  Index most_partial_ = 0;  // pages with free rows, at most
  // Of a change.
  Array<std::uint64_t> keys_, page_keys_;
  Array<Index> order_, found_, partial_, free_pages_, free_before_, before_, freed_;
  Array<Index> counter_ = zeros<Index>(backend_, 1);
  ReadBack<B, Index> counts_;
};

}  // namespace pliant
