#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/topology/pages.hpp>
#include <pliant/topology/shared_list.hpp>

namespace pliant {

namespace detail {

/// A page in the place of another one, which it is a copy of at first; of none it has no values.
template <class V>
struct ChangedPage {
  Index place;  // in the table
  Page<V>* before;
  Page<V>* now;  // none where the list is shorter
};

/// Copies pages, so many bytes at a time, and puts them into a table where there is one.
template <class V>
struct PutPages {
  struct alignas(16) Word {
    std::uint32_t bits[4];
  };
  static_assert(sizeof(Page<V>) % sizeof(Word) == 0);
  static constexpr Index words = sizeof(Page<V>) / sizeof(Word);
  static constexpr Index most_pages = std::numeric_limits<Index>::max() / words;  // in a loop

  ChangedPage<V> const* changed;
  Page<V>** table;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const& own = changed[i / words];
    Index const word = i % words;
    if (word == 0 && table != nullptr) table[own.place] = own.now;
    if (own.before == nullptr) return;
    reinterpret_cast<Word*>(own.now)[word] = reinterpret_cast<Word const*>(own.before)[word];
  }
};

}  // namespace detail

/// A list in pages in a backend's memory, as SharedList is one on the host. Loops change entries in pages that are the
/// list's own since it was kept the last time: until it is kept again, all changes since then can be taken back. Pages that
/// nothing uses any more wait for others.
template <Backend B, class V>
class PagedList {
 public:
  PagedList() = default;
  /// With the entries of a list on the host.
  PagedList(B const& backend, SharedList<V> const& list) {
    extend(backend, list.size());
    for_each_batch(
        backend, [&](std::size_t first, std::span<Page<V>* const> pages, Array<V>& batch) {
          std::vector<V> values(std::min(size_ - first, pages.size() * per_page));
          detail::for_each_on_host(static_cast<Index>(values.size()), 16384, [&](Index i) {
            auto const k = static_cast<std::size_t>(i);
            values[k] = list[first + k];
          });
          batch.upload(values);
          copy(backend, pages, batch, true);
        });
    keep();
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t page_count() const { return pages_.size(); }
  /// How many bytes it takes, pages that wait for others among them.
  [[nodiscard]] std::size_t bytes() const {
    return reserved_ * sizeof(Page<V>) + (table_.size() + table_before_.size()) * sizeof(Page<V>*);
  }
  /// The list as loops see it, until it changes.
  [[nodiscard]] Pages<V> pages() const { return {table_.data()}; }
  /// The entries, on the host.
  [[nodiscard]] std::vector<V> download(B const& backend) {
    std::vector<V> values(size_);
    for_each_batch(backend,
                   [&](std::size_t first, std::span<Page<V>* const> pages, Array<V>& batch) {
                     copy(backend, pages, batch, false);
                     auto const count = std::min(size_ - first, pages.size() * per_page);
                     batch.download(std::span(values).subspan(first, count));
                   });
    return values;
  }

  /// Makes pages of which the byte is not zero the list's own, and room for `count` entries more, which have no value.
  void change(B const& backend, std::span<std::uint8_t const> touched, std::size_t count) {
    std::vector<Index> places;
    for (std::size_t p = 0; p < touched.size(); ++p)
      if (touched[p] != 0 && !is_own(p)) places.push_back(static_cast<Index>(p));
    auto const shared = places.size(), needed = pages_for(size_ + count);
    for (auto p = pages_.size(); p < needed; ++p) places.push_back(static_cast<Index>(p));
    put_new(backend, places, shared, needed);
    size_ += count;
  }
  /// Makes room for so many entries more, beside those of the last page if that is shared with what was kept.
  void extend(B const& backend, std::size_t count) { change(backend, {}, count); }
  /// Puts `count` entries, which have no value, in the place of those from `first` on; those before stay. Gives the list as
  /// it was before, for loops that are asked for until it changes again.
  [[nodiscard]] Pages<V> replace_from(B const& backend, std::size_t first, std::size_t count) {
    detail::grow(backend, table_before_, pages_.size());
    detail::copy_values<B, Page<V>*>(backend, table_.data(), table_before_.data(), pages_.size());
    auto const needed = pages_for(first + count);
    std::vector<Index> places;
    for (auto p = first / per_page; p < needed; ++p) places.push_back(static_cast<Index>(p));
    auto const shared = std::size_t{first % per_page != 0};
    put_new(backend, places, shared, std::max(needed, pages_.size()));
    for (auto p = needed; p < pages_.size(); ++p) change_page(p, nullptr);
    pages_.resize(needed);
    size_ = first + count;
    return {table_before_.data()};
  }

  /// Keeps what changed.
  void keep() {
    for (Changed const& own : changed_) {
      if (own.before != nullptr) free_.push_back(own.before);
      change_of_[static_cast<std::size_t>(own.place)] = none;
    }
    changed_.clear();
    kept_ = size_;
  }
  /// The list is what it was when it was kept.
  void take_back(B const& backend) {
    pages_.resize(std::max(pages_.size(), pages_for(kept_)));
    for (Changed const& own : changed_) {
      auto const place = static_cast<std::size_t>(own.place);
      if (own.now != nullptr) free_.push_back(own.now);
      if (place < pages_.size()) pages_[place] = own.before;
      change_of_[place] = none;
    }
    changed_.clear();
    size_ = kept_;
    pages_.resize(pages_for(size_));
    backend.synchronize();
    table_.upload(pages_);
  }

 private:
  template <class U>
  using Array = typename B::template Array<U>;
  using Changed = detail::ChangedPage<V>;
  static constexpr std::size_t per_page = Page<V>::entries, per_batch = 256;  // pages
  static constexpr Index none = -1;

  static std::size_t pages_for(std::size_t entries) { return (entries + per_page - 1) / per_page; }
  /// Whether a page is not what it was when the list was kept.
  [[nodiscard]] bool is_own(std::size_t p) const {
    return p < change_of_.size() && change_of_[p] != none;
  }
  /// Notes another page at a place, or none. One that came there since the list was kept is free.
  void change_page(std::size_t p, Page<V>* page) {
    if (change_of_.size() <= p) change_of_.resize(p + 1, none);
    if (is_own(p)) {
      auto& now = changed_[static_cast<std::size_t>(change_of_[p])].now;
      if (now != nullptr) free_.push_back(now);
      now = page;
      return;
    }
    change_of_[p] = static_cast<Index>(changed_.size());
    changed_.push_back({static_cast<Index>(p), p < pages_.size() ? pages_[p] : nullptr, page});
  }
  /// Puts new pages at places, the first `copied` of them with what the pages there hold; there are `count` in all then.
  void put_new(B const& backend, std::vector<Index> const& places, std::size_t copied,
               std::size_t count) {
    if (places.empty() && count == pages_.size()) return;
    reserve(backend, places.size(), count);
    std::vector<Changed> changed(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      auto const p = static_cast<std::size_t>(places[i]);
      changed[i] = {places[i], i < copied ? pages_[p] : nullptr, free_[free_.size() - 1 - i]};
    }
    free_.resize(free_.size() - places.size());
    changed_.reserve(changed_.size() + places.size());
    for (Changed const& own : changed) change_page(static_cast<std::size_t>(own.place), own.now);
    pages_.resize(count, nullptr);
    for (Changed const& own : changed) pages_[static_cast<std::size_t>(own.place)] = own.now;
    put(backend, changed, table_.data());
  }

  /// Memory for so many pages more, and a table for so many in all, with some for changes to come.
  void reserve(B const& backend, std::size_t more, std::size_t in_all) {
    if (free_.size() < more) {
      auto const count = std::max({more - free_.size(), reserved_ / 4, std::size_t{16}});
      auto& chunk = chunks_.emplace_back(unset<V>(backend, count * per_page));
      reserved_ += count;
      for (std::size_t p = count; p-- > 0;) free_.push_back(page_in(chunk, p));
    }
    if (table_.size() >= in_all) return;
    auto table = zeros<Page<V>*>(backend, in_all + in_all / 4 + 16);
    backend.synchronize();  // loops may still read the one before
    table.upload(pages_);
    table_ = std::move(table);
  }
  static Page<V>* page_in(Array<V>& chunk, std::size_t p) {
    return reinterpret_cast<Page<V>*>(chunk.data() + p * per_page);
  }
  void put(B const& backend, std::vector<Changed> const& changed, Page<V>** table) {
    using Put = detail::PutPages<V>;
    if (changed.empty()) return;
    auto const listed = upload(backend, changed);
    for (std::size_t first = 0; first < changed.size(); first += Put::most_pages) {
      auto const count =
          static_cast<Index>(std::min<std::size_t>(changed.size() - first, Put::most_pages));
      backend.for_each(count * Put::words, Put{listed.data() + first, table});
    }
  }
  /// Copies pages from a batch, where they lie one after another, or to it.
  void copy(B const& backend, std::span<Page<V>* const> pages, Array<V>& batch, bool from_batch) {
    std::vector<Changed> copies;
    for (std::size_t p = 0; p < pages.size(); ++p) {
      auto* const other = page_in(batch, p);
      copies.push_back({0, from_batch ? other : pages[p], from_batch ? pages[p] : other});
    }
    put(backend, copies, nullptr);
  }
  /// visit(first entry, pages, batch) for some pages after the other.
  template <class Visit>
  void for_each_batch(B const& backend, Visit const& visit) {
    auto batch = zeros<V>(backend, std::min(per_batch, pages_.size()) * per_page);
    for (std::size_t p = 0; p < pages_.size(); p += per_batch)
      visit(p * per_page,
            std::span<Page<V>* const>(pages_).subspan(p, std::min(per_batch, pages_.size() - p)),
            batch);
    backend.synchronize();  // before the batch goes
  }

  std::vector<Page<V>*> pages_;  // in the backend's memory
  std::size_t size_ = 0, kept_ = 0;
  std::vector<Changed> changed_;  // since it was kept: each place once
  std::vector<Index> change_of_;  // by place
  Array<Page<V>*> table_;         // the same as pages_, and room
  Array<Page<V>*> table_before_;  // the last replace_from
  std::vector<Array<V>> chunks_;
  std::vector<Page<V>*> free_;
  std::size_t reserved_ = 0;  // pages
};

}  // namespace pliant
