#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

/// A set of cells of a tree, of which the k-th, ascending, is the element of that number: a bit for each cell, and how many
/// there are before each run of bits, so that a set is copied and changed in a small part of the time that a list takes.
class CellSet {
 public:
  class Iterator {
   public:
    using value_type = Index;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(std::vector<std::uint64_t> const& words, std::size_t word)
        : words_(&words), word_(word), left_(word < words.size() ? words[word] : 0) {
      skip();
    }
    Index operator*() const {
      return static_cast<Index>(per_word * word_) + std::countr_zero(left_);
    }
    Iterator& operator++() {
      left_ &= left_ - 1;
      skip();
      return *this;
    }
    Iterator operator++(int) {
      auto const before = *this;
      ++*this;
      return before;
    }
    Iterator(std::vector<std::uint64_t> const& words, Index cell)
        : Iterator(words, static_cast<std::size_t>(cell) / per_word) {
      while (**this < cell) ++*this;
    }
    bool operator==(Iterator const& other) const {
      return word_ == other.word_ && left_ == other.left_;
    }

   private:
    void skip() {
      while (left_ == 0 && word_ < words_->size())
        if (++word_ < words_->size()) left_ = (*words_)[word_];
    }
    std::vector<std::uint64_t> const* words_ = nullptr;
    std::size_t word_ = 0;
    std::uint64_t left_ = 0;  // of the word: those that are still to come
  };

  CellSet() : before_{0} {}
  /// All cells from one to before another.
  static CellSet range(Index from, Index to) {
    CellSet set;
    set.words_.resize(words_for(to));
    for (Index c = from; c < to; ++c) set.set(c);
    set.count_from(0);
    return set;
  }

  /// Of bits for each cell, 32 in a word.
  static CellSet of_words(std::vector<std::uint32_t> const& words) {
    CellSet set;
    set.words_.resize((words.size() + 1) / 2);
    for (std::size_t w = 0; w < words.size(); ++w)
      set.words_[w / 2] |= std::uint64_t{words[w]} << (w % 2 * 32);
    set.count_from(0);
    return set;
  }

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(before_.back()); }
  [[nodiscard]] Iterator begin() const { return {words_, 0}; }
  [[nodiscard]] Iterator end() const { return {words_, words_.size()}; }
  /// At a place.
  [[nodiscard]] Iterator from(std::size_t place) const {
    return place < size() ? Iterator(words_, (*this)[place]) : end();
  }
  [[nodiscard]] bool contains(Index c) const {
    return word_of(c) < words_.size() && (words_[word_of(c)] >> (at(c) % per_word) & 1) != 0;
  }
  /// How many there are before a cell; of one that is there, its place.
  [[nodiscard]] Index rank(Index c) const {
    std::size_t const word = word_of(c);
    if (word >= words_.size()) return before_.back();
    Index count = before_[word / words_per_run];
    for (std::size_t w = word / words_per_run * words_per_run; w < word; ++w)
      count += std::popcount(words_[w]);
    return count + std::popcount(words_[word] & ((std::uint64_t{1} << (at(c) % per_word)) - 1));
  }
  /// The cell at a place.
  [[nodiscard]] Index operator[](std::size_t place) const {
    auto left = static_cast<Index>(place);
    std::size_t const hint = place / places_per_hint;
    auto const begin = before_.begin() + hints_[hint],
               end = hint + 1 < hints_.size() ? before_.begin() + hints_[hint + 1] + 1
                                              : before_.end();
    auto const run =
        static_cast<std::size_t>(std::upper_bound(begin, end, left) - before_.begin() - 1);
    left -= before_[run];
    std::size_t word = run * words_per_run;
    for (; std::popcount(words_[word]) <= left; ++word) left -= std::popcount(words_[word]);
    return static_cast<Index>(per_word * word) + nth_bit(words_[word], left);
  }

  /// The set without some of its cells; others from `first_moved` on are renumbered(c) then, which ascends; and with some
  /// more, by their new numbers.
  template <class Renumbered>
  [[nodiscard]] CellSet changed(std::vector<Index> const& leaving, Index first_moved,
                                Renumbered const& renumbered,
                                std::vector<Index> const& arriving) const {
    CellSet after = *this;
    for (Index const c : leaving) after.words_[word_of(c)] &= ~bit_of(c);
    std::size_t first = std::min(word_of(first_moved), words_.size());
    auto const moved = [&] {
      CellSet rest;
      rest.words_.assign(after.words_.begin() + static_cast<std::ptrdiff_t>(first),
                         after.words_.end());
      return rest;
    }();
    auto const base = static_cast<Index>(per_word * first);
    std::fill(after.words_.begin() + static_cast<std::ptrdiff_t>(first), after.words_.end(), 0);
    for (Index const c : moved) after.set(base + c < first_moved ? base + c : renumbered(base + c));
    if (!arriving.empty())
      after.words_.resize(std::max(after.words_.size(), words_for(std::ranges::max(arriving) + 1)));
    for (Index const c : arriving) after.set(c);
    auto const lower = [&](auto const& list) {
      for (Index const c : list) first = std::min(first, word_of(c));
    };
    lower(leaving);
    lower(arriving);
    after.count_from(first);
    return after;
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("bits of cells", r.words_...);
    visit("cells before runs of bits", r.before_...);
    visit("runs of every 512th cell", r.hints_...);
  }

 private:
  static constexpr std::size_t per_word = 64, words_per_run = 8, places_per_hint = 512;

  static std::size_t at(Index c) { return static_cast<std::size_t>(c); }
  static std::size_t word_of(Index c) { return at(c) / per_word; }
  static std::uint64_t bit_of(Index c) { return std::uint64_t{1} << (at(c) % per_word); }
  static std::size_t words_for(Index cells) { return (at(cells) + per_word - 1) / per_word; }
  void set(Index c) { words_[word_of(c)] |= bit_of(c); }
  static int nth_bit(std::uint64_t word, Index n) {
    int shift = 0;
    for (int half = 32; half >= 1; half /= 2) {
      auto const low = std::popcount(word & ((std::uint64_t{1} << half) - 1));
      if (low > n) continue;
      n -= low;
      word >>= half;
      shift += half;
    }
    return shift;
  }
  /// Counts those from the run of a word on.
  void count_from(std::size_t word) {
    std::size_t const runs = (words_.size() + words_per_run - 1) / words_per_run;
    std::size_t const first = std::min(word / words_per_run, before_.size() - 1);
    before_.resize(runs + 1);
    hints_.resize((at(before_[first]) + places_per_hint - 1) / places_per_hint);
    for (std::size_t run = first; run < runs; ++run) {
      std::size_t const end = std::min(words_.size(), (run + 1) * words_per_run);
      Index count = before_[run];
      for (std::size_t w = run * words_per_run; w < end; ++w) count += std::popcount(words_[w]);
      before_[run + 1] = count;
      while (hints_.size() * places_per_hint < at(count)) hints_.push_back(static_cast<Index>(run));
    }
  }

  std::vector<std::uint64_t> words_;
  std::vector<Index> before_;  // (runs + 1)
  std::vector<Index> hints_;   // the run of the first, the 513th, ... of the set
};

}  // namespace pliant
