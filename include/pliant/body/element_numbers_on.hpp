#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/cell_set.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/rows_of_element.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

/// The user's numbers of the elements of one type as loops see them: its leaves have theirs in the order of their cells (see
/// CellSet).
struct ElementNumbersView {
  static constexpr Index per_word = 32;

  Index const* leaves;         // by the place in the order of the elements
  std::uint32_t const* words;  // a bit for each cell: whether it is such a leaf
  Index const* before;         // (words + 1): how many leaves there are before each
  Index count_of_words;

  /// Of the element at a place.
  [[nodiscard]] PLIANT_HOST_DEVICE Index number(Index place) const {
    Index const cell = leaves[place], word = cell / per_word;
    auto const those_before = (std::uint32_t{1} << cell % per_word) - 1;
    return before[word] + std::popcount(words[word] & those_before);
  }
  /// The cell of an element with a number.
  [[nodiscard]] PLIANT_HOST_DEVICE Index cell(Index number) const {
    Index low = 0, high = count_of_words;  // its word is in [low, high)
    while (high - low > 1) {
      Index const middle = low + (high - low) / 2;
      (before[middle] <= number ? low : high) = middle;
    }
    auto left = words[low];
    for (Index k = before[low]; k < number; ++k) left &= left - 1;
    // How many zeros it ends in: std::countr_zero gives 32 in what nvcc 13.0 makes for devices.
    return low * per_word + std::popcount(~left & (left - 1));
  }
};

namespace detail {

struct FindLeaves {
  TreeView tree;
  CellsOfType is_one;
  Index cells, first_word;
  std::uint32_t* words;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    constexpr Index per_word = ElementNumbersView::per_word;
    Index const w = first_word + k, first = w * per_word, count = cells - first;
    std::uint32_t bits = 0;
    // So many reads in any case, none of which hangs on another: a device waits for memory once.
    auto const cell_at = [&](Index c) -> TreeCell const& {
      return tree.cells[static_cast<std::size_t>(first + (c < count ? c : count - 1))];
    };
    for (Index c = 0; c < per_word; ++c) bits |= std::uint32_t{cell_at(c).first_child < 0} << c;
    if (is_one.has_others)
      for (Index c = 0; c < per_word; ++c) bits &= ~(std::uint32_t{!is_one(cell_at(c))} << c);
    if (count < per_word) bits &= (std::uint32_t{1} << count) - 1;
    words[w] = bits;
  }
};
/// Changes the bits of cells before a word, where these became leaves or ceased to be such.
struct ChangeLeaves {
  TreeView tree{};
  CellsOfType is_one{};
  Index first_word = 0;
  std::uint32_t* words = nullptr;

  /// Of a cell, which no other call does.
  PLIANT_HOST_DEVICE void change(Index cell, bool is_leaf) const {
    constexpr Index per_word = ElementNumbersView::per_word;
    if (cell / per_word >= first_word || !is_one(tree.cells[static_cast<std::size_t>(cell)]))
      return;
    std::uint32_t const bit = std::uint32_t{1} << cell % per_word;
    atomic_add(words[cell / per_word], is_leaf ? bit : 0 - bit);
  }
};
struct ChangeRefinedLeaves : ChangeLeaves {
  CellSplit const* refined;
  PLIANT_HOST_DEVICE void operator()(Index i) const { change(refined[i].cell, false); }
};
struct ChangeMergedLeaves : ChangeLeaves {
  Index const* parents;
  PLIANT_HOST_DEVICE void operator()(Index i) const { change(parents[i], true); }
};
/// Of leaves that got another degree: no others have them then.
struct ChangeConvertedLeaves : ChangeLeaves {
  Index const* cells;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    constexpr Index per_word = ElementNumbersView::per_word;
    Index const cell = cells[i];
    if (cell / per_word >= first_word) return;
    auto& word = words[cell / per_word];
    std::uint32_t const bit = std::uint32_t{1} << cell % per_word;
    bool const was = (atomic_load(word) & bit) != 0,
               is = is_one(tree.cells[static_cast<std::size_t>(cell)]);
    if (was != is) atomic_add(word, is ? bit : 0 - bit);
  }
};
struct CountLeaves {
  std::uint32_t const* words;
  PLIANT_HOST_DEVICE Index operator()(Index w) const { return std::popcount(words[w]); }
};
/// The user's numbers of elements at places; without a list of these, at all.
struct PutNumbers {
  ElementNumbersView of;
  Index const* places;
  Index* numbers;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    numbers[i] = of.number(places == nullptr ? i : places[i]);
  }
};
/// The cells of elements with some numbers; of a number that none has, the first one's, and *unknown is set.
struct LookUpCells {
  ElementNumbersView of;
  Index count;  // of elements, not 0
  Index const* numbers;
  Index *cells, *unknown;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const number = numbers[i];
    bool const is_known = number >= 0 && number < count;
    if (!is_known) *unknown = 1;
    cells[i] = of.cell(is_known ? number : 0);
  }
};

}  // namespace detail

/// What ElementNumbersView sees, in a backend's memory.
template <Backend B>
class ElementNumbersOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  ElementNumbersOn() = default;
  /// Of the leaves of a type that there are now.
  ElementNumbersOn(B const& backend, TreeOn<B> const& tree, detail::CellsOfType const& type)
      : is_one_(type) {
    follow(backend, tree, 0, 0, detail::ChangeMergedLeaves{});
  }

  /// `leaves`: of the type now.
  [[nodiscard]] ElementNumbersView of(LeavesView const& leaves) const {
    return {leaves.leaves, words_.data(), before_.data(), count_of_words_};
  }

  /// These leaves, on the host.
  [[nodiscard]] CellSet leaves() const {
    std::vector<std::uint32_t> words(static_cast<std::size_t>(count_of_words_));
    words_.download(words);
    return CellSet::of_words(words);
  }

  /// The same after a refinement of the tree.
  void follow(B const& backend, TreeOn<B> const& tree, typename TreeOn<B>::Refined const& refined) {
    follow(backend, tree, cells_ / per_word, refined.leaves,
           detail::ChangeRefinedLeaves{{}, refined.cells});
  }
  /// And after leaves got another degree.
  void follow(B const& backend, TreeOn<B> const& tree, Raised const& raised) {
    follow(backend, tree, cells_ / per_word, raised.raised,
           detail::ChangeConvertedLeaves{{}, raised.cells});
  }
  void follow(B const& backend, TreeOn<B> const& tree, Lowered const& lowered) {
    follow(backend, tree, cells_ / per_word, lowered.lowered,
           detail::ChangeConvertedLeaves{{}, lowered.lowered_cells});
  }
  /// And after a coarsening.
  void follow(B const& backend, TreeOn<B> const& tree, Coarsened const& coarsened) {
    follow(backend, tree, coarsened.staying.cells / per_word, coarsened.merged,
           detail::ChangeMergedLeaves{{}, coarsened.parents});
  }

 private:
  static constexpr Index per_word = ElementNumbersView::per_word;

  /// Of cells before word `first_word`, the bits of those change that change(i) is for, i < count; the others' are found.
  template <class Change>
  void follow(B const& backend, TreeOn<B> const& tree, Index first_word, Index count,
              Change change) {
    auto const words_before = static_cast<std::size_t>(count_of_words_);
    cells_ = tree.sizes().cells;
    count_of_words_ = cells_ / per_word + (cells_ % per_word > 0 ? 1 : 0);
    auto const words = static_cast<std::size_t>(count_of_words_);
    detail::grow_keeping(backend, words_, words_before, words);
    detail::grow(backend, before_, words + 1);
    static_cast<detail::ChangeLeaves&>(change) = {tree.view(), is_one_, first_word, words_.data()};
    detail::in_turn(backend, detail::LoopStep{count, change},
                    detail::LoopStep{count_of_words_ - first_word,
                                     detail::FindLeaves{tree.view(), is_one_, cells_, first_word,
                                                        words_.data()}});
    backend.scan(count_of_words_, detail::CountLeaves{words_.data()}, before_.data());
  }

  detail::CellsOfType is_one_{};
  Array<std::uint32_t> words_;
  Array<Index> before_;
  Index cells_ = 0, count_of_words_ = 0;
};

}  // namespace pliant
