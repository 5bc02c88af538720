#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <pliant/topology/pages.hpp>

namespace pliant::detail {

/// Which pages a list has, which it had when it was kept the last time, and which wait for others. Whoever has pages taken sees
/// to it that there are enough, and room for them and for those that are left: then nothing here throws.
template <class V>
class KeptPages {
 public:
  [[nodiscard]] std::vector<Page<V>*> const& now() const { return pages_; }
  [[nodiscard]] std::size_t size() const { return pages_.size(); }
  /// How many there were when the list was kept.
  [[nodiscard]] std::size_t kept() const { return kept_; }
  [[nodiscard]] Page<V>* operator[](std::size_t p) const { return pages_[p]; }
  [[nodiscard]] std::size_t free_pages() const { return free_.size(); }
  /// The free pages that come behind the others, or in the place of all of them, when so many are taken at once.
  [[nodiscard]] std::span<Page<V>* const> next(std::size_t count) const {
    return std::span(free_).last(count);
  }
  /// Whether a page is not what it was when the list was kept.
  [[nodiscard]] bool is_own(std::size_t p) const { return p >= kept_ || is_left_[p] != 0; }
  /// Whether the list has the pages that it had when it was kept.
  [[nodiscard]] bool is_kept() const {
    return pages_.size() == kept_ && left_.empty() && all_left_.empty();
  }

  /// Room for so many pages in all, of which some are in use.
  void reserve(std::size_t in_all) { free_.reserve(in_all); }
  /// Room for so many in the list, and some for changes to come.
  void reserve_places(std::size_t count) {
    if (pages_.capacity() < count) pages_.reserve(count + count / 4);
  }
  void add_free(Page<V>* page) { free_.push_back(page); }
  /// Room for so many pages more that are left one by one.
  void reserve_left(std::size_t more) { left_.reserve(left_.size() + more); }
  /// Room to leave all pages at once.
  void reserve_all_left() { all_left_.reserve(pages_.size()); }

  /// Another page in the place of one: gives it.
  Page<V>* replace(std::size_t p) {
    Page<V>* const page = free_.back();
    free_.pop_back();
    leave(p, std::exchange(pages_[p], page));
    return page;
  }
  /// Other pages in the place of all, which are those that were kept.
  void replace_all() {
    all_left_.swap(pages_);
    pages_.assign(free_.end() - static_cast<std::ptrdiff_t>(kept_), free_.end());
    free_.resize(free_.size() - kept_);
    std::ranges::fill(is_left_, 1);
  }
  /// Free pages behind the others, until there are so many.
  void extend(std::size_t count) {
    auto const more = count - pages_.size();
    pages_.insert(pages_.end(), free_.end() - static_cast<std::ptrdiff_t>(more), free_.end());
    free_.resize(free_.size() - more);
  }
  /// So many pages stay; those behind them are left when it is said so.
  void cut(std::size_t staying) { pages_.resize(staying); }
  /// Another page, or none, is in the place of one. One that came there since the list was kept is free.
  void leave(std::size_t p, Page<V>* before) {
    if (is_own(p)) {
      free_.push_back(before);
    } else {
      left_.push_back({p, before});
      is_left_[p] = 1;
    }
  }

  /// Keeps what changed.
  void keep() {
    free_.insert(free_.end(), all_left_.begin(), all_left_.end());
    if (!all_left_.empty()) std::ranges::fill(is_left_, 0);
    all_left_.clear();
    for (Left const& page : left_) {
      free_.push_back(page.before);
      is_left_[page.place] = 0;
    }
    left_.clear();
    kept_ = pages_.size();
    is_left_.resize(kept_);
  }
  /// The pages are those that were kept. visit(p) for those that come again.
  template <class Visit>
  void take_back(Visit const& visit) {
    if (!all_left_.empty()) {
      free_.insert(free_.end(), pages_.begin(), pages_.end());
      pages_.swap(all_left_);
      all_left_.clear();
      std::ranges::fill(is_left_, 0);
      for (std::size_t p = 0; p < kept_; ++p) visit(p);
      return;
    }
    for (auto p = kept_; p < pages_.size(); ++p) free_.push_back(pages_[p]);
    for (Left const& page : left_)
      if (page.place < pages_.size()) free_.push_back(pages_[page.place]);
    pages_.resize(kept_);
    for (Left const& page : left_) {
      pages_[page.place] = page.before;
      is_left_[page.place] = 0;
      visit(page.place);
    }
    left_.clear();
  }

 private:
  /// A page that was kept, and that the list has not any more.
  struct Left {
    std::size_t place;
    Page<V>* before;
  };

  std::vector<Page<V>*> pages_;        // in a backend's memory
  std::size_t kept_ = 0;               // how many there were when the list was kept
  std::vector<Left> left_;             // since then: each place once
  std::vector<Page<V>*> all_left_;     // or all of them at once
  std::vector<std::uint8_t> is_left_;  // by place among those pages
  std::vector<Page<V>*> free_;
};

}  // namespace pliant::detail
