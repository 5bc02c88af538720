#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/topology/tree_on.hpp>

// The order of elements that a body keeps, in a backend's memory.
namespace pliant {

namespace detail {

/// Notes where leaves were divided, by their places: into how many.
struct MarkDividedPlaces {
  CellSplit const* leaves;
  LeafParts const* parts;
  Index const* places;
  std::uint8_t* into;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    into[places[leaves[r].cell]] = static_cast<std::uint8_t>(parts[r].cells);
  }
};
/// How many leaves stand in the place of one.
struct LeavesInPlace {
  std::uint8_t const* into;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return into[i] == 0 ? 1 : Index{into[i]}; }
};
/// Puts leaves, or the children in their place, where they stand now.
struct PutLeaves {
  TreeView tree;
  std::uint8_t const* into;
  Index const* before;  // leaves, by their places
  Index const* start;   // their places now
  Index* leaves;
  Index* places;  // by cell
  Index* from;    // by the place now: that before, of a child its parent's

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = before[i];
    if (into[i] == 0) return put(start[i], cell, i);
    Index const first = tree.cells[static_cast<std::size_t>(cell)].first_child;
    for (Index k = 0; k < Index{into[i]}; ++k) put(start[i] + k, first + k, i);
  }

 private:
  PLIANT_HOST_DEVICE void put(Index place, Index cell, Index old) const {
    leaves[place] = cell;
    places[cell] = place;
    from[place] = old;
  }
};
struct PutPlaces {
  Index const* leaves;
  Index* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const { places[leaves[i]] = i; }
};
/// numbers[k] = of[numbers[k]]
struct LookUp {
  Index const* of;
  Index* numbers;
  PLIANT_HOST_DEVICE void operator()(Index k) const { numbers[k] = of[numbers[k]]; }
};

}  // namespace detail

/// The leaves of a tree in a backend's memory, in the order that a body keeps (see CellOrder): children stand in the place of
/// their parents.
template <Backend B>
class LeafOrderOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// Of a tree of which nothing is divided.
  LeafOrderOn(B const& backend, CellOrder const& first)
      : LeafOrderOn(backend, first.cells, first_blocks(first.count()), first.count()) {}
  /// Of leaves in this order; `first_of_block`: see below; `cells`: how many cells the tree has.
  LeafOrderOn(B const& backend, std::vector<Index> const& leaves,
              std::vector<Index> const& first_of_block, Index cells)
      : backend_(backend),
        leaves_(upload(backend, leaves)),
        first_(upload(backend, first_of_block)),
        count_(static_cast<Index>(leaves.size())),
        blocks_(static_cast<Index>(first_of_block.size()) - 1) {
    detail::grow(backend_, places_, static_cast<std::size_t>(cells));
    backend_.for_each(count_, detail::PutPlaces{leaves_.data(), places_.data()});
  }

  [[nodiscard]] Index count() const { return count_; }
  /// The leaves by their places, and places by cell, of those that are leaves.
  [[nodiscard]] Index const* leaves() const { return leaves_.data(); }
  [[nodiscard]] Index const* places() const { return places_.data(); }
  /// By the place: that before the last change, of a child its parent's.
  [[nodiscard]] Index const* from() const { return from_.data(); }
  /// The leaves before the last change, by their places then. There is no such change of a first mesh.
  [[nodiscard]] Index const* before() const { return others_.data(); }
  [[nodiscard]] Index count_before() const { return count_before_; }
  /// The place of the first leaf of each block, and behind the last one.
  [[nodiscard]] Index const* first_of_block() const { return first_.data(); }
  [[nodiscard]] Index blocks() const { return blocks_; }
  /// A copy of first_of_block on the host.
  [[nodiscard]] std::vector<Index> download_first_of_block() const {
    std::vector<Index> first(static_cast<std::size_t>(blocks_) + 1);
    first_.download(first);
    return first;
  }

  /// Puts the children of refined leaves in the place of these.
  void refine(TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined) {
    auto const before = static_cast<std::size_t>(count_);
    Index const after = tree.leaves();
    auto into = zeros<std::uint8_t>(backend_, before);
    detail::grow(backend_, start_, before + 1);
    detail::grow(backend_, others_, static_cast<std::size_t>(after));
    detail::grow(backend_, from_, static_cast<std::size_t>(after));
    detail::grow_keeping(backend_, places_, places_.size(),
                         static_cast<std::size_t>(tree.sizes().cells));
    backend_.for_each(refined.leaves, detail::MarkDividedPlaces{refined.cells, refined.parts,
                                                                places_.data(), into.data()});
    backend_.scan(count_, detail::LeavesInPlace{into.data()}, start_.data());
    backend_.for_each(count_,
                      detail::PutLeaves{tree.view(), into.data(), leaves_.data(), start_.data(),
                                        others_.data(), places_.data(), from_.data()});
    backend_.for_each(blocks_ + 1, detail::LookUp{start_.data(), first_.data()});
    std::swap(leaves_, others_);
    count_before_ = std::exchange(count_, after);
  }

 private:
  static std::vector<Index> first_blocks(Index count) {
    std::vector<Index> first;
    for (Index c = 0; c < count; c += cells_per_block) first.push_back(c);
    first.push_back(count);
    return first;
  }

  B backend_;
  Array<Index> leaves_, others_;  // others: those before a change, or room
  Array<Index> places_, from_, start_, first_;
  Index count_ = 0, count_before_ = 0, blocks_ = 0;
};

}  // namespace pliant
