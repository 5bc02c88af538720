#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/body/converted_leaf_passes.hpp>
#include <pliant/body/leaf_order_passes.hpp>
#include <pliant/topology/tree_on.hpp>

// The order of elements that a body keeps, in a backend's memory.
namespace pliant {

/// Leaves that follow each other in the order that a body keeps, as those of one element type do, before and after a change: places
/// are counted from the first of these.
struct LeavesView {
  Index const* leaves = nullptr;  // by the place
  Index const* before =
      nullptr;  // by the place before the change, by the numbers that they have now; −1: merged, or of others now
  Index const* from_all = nullptr;  // by the place: that before, counted from the first of all
  Index const* places = nullptr;    // by cell, counted from the first of all
  MergedFamily const* families = nullptr;  // those that the change merged, of all
  Index merged = 0;                        // how many
  Index first = 0, first_before = 0;       // of all
  Index count = 0, count_before = 0;
  bool has_others = false;  // whether there are other leaves

  /// The place before of the leaf at a place, of a child its parent's, of a merged parent its first child's.
  [[nodiscard]] PLIANT_HOST_DEVICE Index from(Index i) const { return from_all[i] - first_before; }
  /// Whether it was none of these then: it, or what it came for, was of another type.
  [[nodiscard]] PLIANT_HOST_DEVICE bool comes_from_others(Index i) const {
    return has_others && (from(i) < 0 || from(i) >= count_before);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_new(Index i) const {
    return before[from(i)] != leaves[i];
  }
  /// Of merged family r: how many children, none if it is not of these leaves; its place, and that of its first child before.
  [[nodiscard]] PLIANT_HOST_DEVICE Index children(Index r) const {
    if (!has_others) return families[r].children;
    auto const& own = families[r];
    return own.place < first || own.place >= first + count ? 0 : own.children;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index merged_place(Index r) const {
    return families[r].place - first;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index first_child_before(Index r) const {
    return families[r].first_before - first_before;
  }
};

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
        told_(backend, first_of_block.size()),
        count_(static_cast<Index>(leaves.size())),
        blocks_(static_cast<Index>(first_of_block.size()) - 1) {
    detail::grow(backend_, places_, static_cast<std::size_t>(cells));
    detail::copy_values<B, Index>(backend_, first_.data(), told_.data(), first_of_block.size());
    backend_.for_each(count_, detail::PutPlaces{leaves_.data(), places_.data()});
  }

  [[nodiscard]] Index count() const { return count_; }
  /// The leaves by their places, and places by cell, of those that are leaves.
  [[nodiscard]] Index const* leaves() const { return leaves_.data(); }
  [[nodiscard]] Index const* places() const { return places_.data(); }
  /// By the place: that before the last change, of a child its parent's, of a merged parent its first child's.
  [[nodiscard]] Index const* from() const { return from_.data(); }
  /// The leaves before the last change, by their places then and by the numbers that they have now; −1: merged into others. So
  /// a leaf was there before where before()[from()[i]] is the same. There is no such change of a first mesh.
  [[nodiscard]] Index const* before() const { return others_.data(); }
  [[nodiscard]] Index count_before() const { return count_before_; }
  /// What the last change merged: (merged_count()), in the order of Coarsened::parents. Nothing, if that was a refinement.
  [[nodiscard]] MergedFamily const* merged_families() const { return families_.data(); }
  [[nodiscard]] Index merged_count() const { return merged_; }
  /// What the last change converted, if it did.
  [[nodiscard]] ConvertedFamily const* converted_families() const { return converted_.data(); }
  [[nodiscard]] Index converted_count() const { return converted_count_; }
  /// How many leaves before each block stayed, once the backend was waited for since such a change.
  [[nodiscard]] std::vector<Index> told_staying() const { return told_staying_.all(); }
  /// The place of the first leaf of each block, and behind the last one.
  [[nodiscard]] Index const* first_of_block() const { return first_.data(); }
  [[nodiscard]] Index blocks() const { return blocks_; }
  /// A copy of first_of_block on the host, once the backend was waited for since the last change.
  [[nodiscard]] std::vector<Index> told_first_of_block() const { return told_.all(); }

  /// All of them.
  [[nodiscard]] LeavesView view() const { return view(0, count_, 0, count_before_, false); }
  /// `count` of them from the place `first` on, which were `count_before` from `first_before` on.
  [[nodiscard]] LeavesView view(Index first, Index count, Index first_before, Index count_before,
                                bool has_others) const {
    return {leaves_.data() + first,
            others_.data() + first_before,
            from_.data() + first,
            places_.data(),
            families_.data(),
            merged_,
            first,
            first_before,
            count,
            count_before,
            has_others};
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
    backend_.for_each(blocks_ + 1, detail::MoveBlocks{start_.data(), first_.data(), told_.data()});
    std::swap(leaves_, others_);
    count_before_ = std::exchange(count_, after);
    merged_ = 0;
  }

  /// Puts leaves that are of another type now into other blocks: `other_block`, by block. `first`: places of the initial mesh's cells. All
  /// arrays are in the backend's memory. Of leaves that have another degree,
  void convert(TreeOn<B> const& tree, Index const* cells, Index count, Index const* other_block,
               Index const* first) {
    convert_by(tree, count, count, {tree.sizes().cells, nullptr}, other_block, first,
               [&](auto const& leaving) {
                 return detail::LeaveConverted{leaving, cells};
               });
  }
  /// of leaves that were split,
  void convert(TreeOn<B> const& tree, typename TreeOn<B>::Split const& done,
               Index const* other_block, Index const* first) {
    detail::grow_keeping(backend_, places_, places_.size(),
                         static_cast<std::size_t>(tree.sizes().cells));
    convert_by(tree, done.leaves, tree.leaves() - count_ + done.leaves,
               {tree.sizes().cells, nullptr}, other_block, first, [&](auto const& leaving) {
                 return detail::LeaveSplit{leaving, done.cells, done.parts};
               });
  }
  /// of such that were merged,
  void convert(TreeOn<B> const& tree, Merged const& done, Index const* other_block,
               Index const* first) {
    convert_by(tree, done.merged, done.merged, detail::new_cells(done), other_block, first,
               [&](auto const& leaving) {
                 return detail::LeaveMerged{leaving, done};
               });
  }

  /// and those of a tree with pyramids that were refined, or whose children were merged: tetrahedra are among the children of pyramids, and
  /// stand so many blocks behind them.
  void convert(TreeOn<B> const& tree, typename TreeOn<B>::Refined const& done, Index blocks_to_tets,
               Index const* first) {
    detail::grow_keeping(backend_, places_, places_.size(),
                         static_cast<std::size_t>(tree.sizes().cells));
    convert_by(
        tree, done.leaves, detail::tets_of_pyramid * done.leaves, {tree.sizes().cells, nullptr},
        nullptr, first, [&](auto const& leaving) {
          return detail::LeaveRefined{leaving, tree.view(), done.cells, done.parts, blocks_to_tets};
        });
  }
  void convert(TreeOn<B> const& tree, Coarsened const& done, Index const* first) {
    detail::grow(backend_, families_, static_cast<std::size_t>(done.merged));
    convert_by(tree, done.merged, done.merged, detail::new_cells(done), nullptr, first,
               [&](auto const& leaving) {
                 return detail::LeaveCoarsened{leaving, tree.view(), done, families_.data()};
               });
    backend_.for_each(done.merged, detail::FindMergedPlaces{families_.data(), places_.data()});
    merged_ = done.merged;
  }

  /// Puts merged parents in the place where their children stood. `tree`: after that.
  void coarsen(TreeOn<B> const& tree, Coarsened const& done) {
    auto const before = static_cast<std::size_t>(count_);
    Index const after = tree.leaves();
    auto merged = zeros<std::uint8_t>(backend_, before);
    detail::grow(backend_, families_, static_cast<std::size_t>(done.merged));
    detail::grow(backend_, start_, before + 1);
    detail::grow(backend_, others_, static_cast<std::size_t>(after));
    detail::grow(backend_, from_, static_cast<std::size_t>(after));
    backend_.for_each(done.merged, detail::FindFamilies{tree.view(), done, places_.data(),
                                                        families_.data(), merged.data()});
    backend_.scan(count_, detail::PlacesKept{merged.data()}, start_.data());
    backend_.for_each(
        count_, detail::MoveLeaves{detail::new_cells(done), merged.data(), start_.data(),
                                   leaves_.data(), others_.data(), places_.data(), from_.data()});
    backend_.for_each(done.merged, detail::PutMerged{families_.data(), start_.data(),
                                                     others_.data(), places_.data(), from_.data()});
    backend_.for_each(blocks_ + 1, detail::MoveBlocks{start_.data(), first_.data(), told_.data()});
    std::swap(leaves_, others_);
    count_before_ = std::exchange(count_, after);
    merged_ = done.merged;
  }

 private:
  /// `families`: how many leaves go, each or several of one parent; `come`: how many come; leave(a LeavePlaces): a loop over families.
  template <class MakeLeave>
  void convert_by(TreeOn<B> const& tree, Index families, Index come,
                  detail::NewNumbers const& cells, Index const* other_block, Index const* first,
                  MakeLeave const& leave) {
    using detail::LoopStep, detail::ScanStep, detail::SortStep;
    auto const room = [&](auto& array, Index count) {
      detail::grow(backend_, array, static_cast<std::size_t>(count));
    };
    Index const after = tree.leaves();
    auto in_place = zeros<std::uint8_t>(backend_, static_cast<std::size_t>(count_));
    room(start_, count_ + 1);
    room(staying_, after);
    room(others_, after);
    room(from_, after);
    room(keys_, come);
    room(arriving_, come);
    room(converted_, families);
    if (told_staying_.size() == 0) told_staying_ = ReadBack<B, Index>(backend_, told_.size());
    detail::LeafBlocks const blocks{first_.data(), blocks_};
    detail::ArrivingLeaves const arriving{come, keys_.data(), arriving_.data()};
    detail::PutConverted const put{
        {tree.view(), first}, blocks,         arriving,        cells,
        {in_place.data()},    start_.data(),  staying_.data(), leaves_.data(),
        others_.data(),       places_.data(), from_.data()};
    int const bits = detail::LeavePlaces::bits_of_place + detail::key_bits(blocks_ + 1);
    detail::in_turn(
        backend_,
        LoopStep{families,
                 leave(detail::LeavePlaces{blocks, other_block, places_.data(), in_place.data(),
                                           keys_.data(), arriving_.data(), converted_.data()})},
        SortStep{come, keys_.data(), arriving_.data(), bits},
        ScanStep{count_, detail::LeavesThere{in_place.data()}, start_.data()},
        LoopStep{count_, detail::ListStayingLeaves{put}}, LoopStep{count_, detail::PutStaying{put}},
        LoopStep{come, detail::PutArriving{put}},
        LoopStep{blocks_ + 1, detail::MoveBlocksOfConverted{arriving, start_.data(), first_.data(),
                                                            told_.data(), told_staying_.data()}});
    std::swap(leaves_, others_);
    count_before_ = std::exchange(count_, after);
    merged_ = 0;
    converted_count_ = families;
  }

  static std::vector<Index> first_blocks(Index count) {
    std::vector<Index> first;
    for (Index c = 0; c < count; c += cells_per_block) first.push_back(c);
    first.push_back(count);
    return first;
  }

  B backend_;
  Array<Index> leaves_, others_;  // others: those before a change, or room
  Array<Index> places_, from_, start_, first_;
  ReadBack<B, Index> told_;  // first_
  Array<MergedFamily> families_;
  Array<ConvertedFamily> converted_;
  Array<Index> staying_;  // leaves, of a change that converts some
  ReadBack<B, Index> told_staying_;
  Array<std::uint64_t> keys_;  // of leaves that go over to another type
  Array<Index> arriving_;
  Index count_ = 0, count_before_ = 0, blocks_ = 0, merged_ = 0, converted_count_ = 0;
};

}  // namespace pliant
