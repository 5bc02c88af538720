#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/math/unset_vector.hpp>
#include <pliant/topology/page_passes.hpp>
#include <pliant/topology/pages.hpp>
#include <pliant/topology/shared_list.hpp>

namespace pliant {

/// A list in pages in a backend's memory, as SharedList is one on the host. Loops change entries in pages that are the
/// list's own since it was kept the last time: until it is kept again, all changes since then can be taken back. Pages that
/// nothing uses any more wait for others. Which page is where is known in the backend's memory; the host knows how many there are.
template <Backend B, class V>
class PagedList {
  template <class U>
  using Array = typename B::template Array<U>;
  using PutPages = detail::LoopStep<detail::ExtendTable<V>>;

 public:
  PagedList() = default;
  /// With the entries of a list on the host.
  PagedList(B const& backend, SharedList<V> const& list) {
    extend(backend, list.size()).run(backend);
    UnsetVector<V> values;
    for (std::size_t first = 0; first < size_; first += per_batch * per_page) {
      values.resize(std::min(size_ - first, per_batch * per_page));
      detail::for_each_on_host(pages_for(values.size()), 64, [&](Index p) {
        auto const from = at(p) * per_page;
        std::copy_n(&list[first + from], std::min(per_page, values.size() - from),
                    values.data() + from);
      });
      chunks_.front().upload(values, first);  // of which the pages are the first ones
    }
    keep();
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  /// How many bytes it takes, pages that wait for others among them.
  [[nodiscard]] std::size_t bytes() const {
    return at(reserved_) * (sizeof(Page<V>) + sizeof(Page<V>*) + sizeof(Index)) +
           table_.size() * (sizeof(Page<V>*) + 2 * sizeof(Index) + 1) +
           table_before_.size() * sizeof(Page<V>*);
  }
  /// The list as loops see it, until it changes.
  [[nodiscard]] Pages<V> pages() const { return {table_.data()}; }
  /// The entries, on the host.
  [[nodiscard]] std::vector<V> download(B const& backend) {
    std::vector<V> values(size_);
    auto batch = unset<V>(backend, std::min(per_batch, at(pages_)) * per_page);
    for (std::size_t first = 0; first < size_; first += batch.size()) {
      gather(backend, nullptr, page_of(first), batch, size_ - first);
      batch.download(std::span(values).subspan(first, std::min(size_ - first, batch.size())));
    }
    return values;
  }

  /// A list on the host with the same entries. `like`: what the list was when it was made or began to note changes; pages that
  /// have not changed since then are shared with that.
  [[nodiscard]] SharedList<V> download(B const& backend, SharedList<V> const& like) {
    SharedList<V> list = like;
    if (list.size() > size_) list.shrink(size_);
    list.extend(size_ - list.size());
    auto const noted = on_host<std::uint8_t>(noted_);
    std::vector<Index> changed;
    for (Index p = 0; p < pages_; ++p)
      if (noted[at(p)] != 0) changed.push_back(p);
    auto const listed = upload(backend, changed);
    auto batch = unset<V>(backend, std::min(per_batch, changed.size()) * per_page);
    std::vector<V> values;
    for (std::size_t first = 0; first < changed.size(); first += per_batch) {
      std::span const some =
          std::span(changed).subspan(first, std::min(per_batch, changed.size() - first));
      gather(backend, listed.data() + first, 0, batch, some.size() * per_page);
      values.resize(some.size() * per_page);
      batch.download(values);
      for (std::size_t k = 0; k < some.size(); ++k) {
        auto const place = at(some[k]) * per_page;
        auto const from = values.begin() + static_cast<std::ptrdiff_t>(k * per_page);
        std::copy_n(from, std::min(per_page, size_ - place), &list.edit(place));
      }
    }
    return list;
  }
  /// Notes which pages change from now on, for that.
  void begin_noting(B const& backend) {
    backend.for_each(pages_, detail::BeginNoting{own_.data(), now_, noted_.data()});
  }

  // Memory for what comes: then own, extend and replace_from of so much throw nothing. Steps of what these give have to run, so that all
  // that may throw comes before.

  void reserve_own(B const& backend, Index count) { reserve(backend, count, pages_); }
  void reserve_extend(B const& backend, std::size_t count) {
    Index const needed = std::max(pages_, pages_for(size_ + count));
    reserve(backend, needed - pages_, needed);
  }
  void reserve_replace(B const& backend, std::size_t first, std::size_t count) {
    Index const needed = pages_for(first + count);
    reserve(backend, needed - page_of(first), std::max(needed, pages_));
    detail::grow(backend, table_before_, at(pages_));
  }

  /// For loops that mark pages which others are about to change. `count`: zero, in the backend's memory; how many they list.
  [[nodiscard]] detail::PageMarker marker(B const& backend, Index* count) {
    detail::grow(backend, listed_, at(pages_));
    return {{own_.data(), now_, listed_.data(), count}, noted_.data()};
  }
  /// Makes the pages the list's own that were listed: steps that put others in their place, and that copy so many words.
  struct Own {
    detail::LoopStep<detail::ReplaceListedPages<V>> replace;
    detail::CopyListedPages<V> copy;
    std::size_t words;
  };
  [[nodiscard]] Own own(B const& backend, Index count) {
    reserve_own(backend, count);
    free_ -= count;
    left_ += count;
    auto const tables = this->tables();
    Index const first = base_ + free_;
    return {{count, {tables, listed_.data(), first}},
            {tables, listed_.data(), first},
            at(count) * detail::PageWords<V>::each};
  }
  /// Makes room for so many entries more, which have no value, beside those of the last page if that is shared with what was
  /// kept. Loops see it behind the step that this returns.
  [[nodiscard]] PutPages extend(B const& backend, std::size_t count) {
    Index const before = pages_, needed = std::max(before, pages_for(size_ + count));
    Index const from = count > 0 ? page_of(size_) : needed;
    reserve_extend(backend, count);
    Index const first = take_free(needed - before);
    pages_ = needed;
    size_ += count;
    return {needed - from, {tables(), from, before, first}};
  }
  /// Puts `count` entries, which have no value, in the place of those from `first` on; those before stay. Gives the list as
  /// it was from there on, for loops that are asked for until it changes again, and steps behind which loops see it.
  struct Replaced {
    Pages<V> before;
    detail::LoopStep<detail::ReplaceFrom<V>> replace;
    detail::LoopStep<detail::CopyPageOf<V>> copy;
    PutPages extend;
  };
  [[nodiscard]] Replaced replace_from(B const& backend, std::size_t first, std::size_t count) {
    Index const staying = page_of(first), needed = pages_for(first + count), before = pages_;
    Index const left = before - staying, now = std::min(needed, before) - staying;
    reserve_replace(backend, first, count);
    auto const tables = this->tables();
    Index const more = std::max(needed - before, Index{0}), base = take_free(more);
    Index const slot = base_ + free_ - now, behind = base_ + free_ + left_;
    free_ -= now;
    left_ += left;
    pages_ = needed;
    size_ = first + count;
    bool const keeps_entries = first % per_page != 0;  // of the first page that is left
    auto* const old = table_before_.data();
    return {{old},
            {left, {tables, staying, now, slot, behind, old}},
            {keeps_entries ? static_cast<Index>(detail::PageWords<V>::each) : 0,
             {old, table_.data(), staying}},
            {more, {tables, before, before, base}}};
  }

  /// Keeps what changed.
  void keep() {
    free_ += std::exchange(left_, 0);
    ++now_;
    kept_pages_ = pages_;
    kept_ = size_;
  }
  /// The list is what it was when it was kept.
  void take_back(B const& backend) {
    // Those that went come again; what else changed is the list's own, and noted.
    if (pages_ < kept_pages_)
      backend.for_each(kept_pages_ - pages_,
                       detail::FillValue<std::uint8_t>{noted_.data() + pages_, 1});
    auto const capacity = at(reserved_);
    std::span const table(host_table_), ring(host_ring_), slots(host_slots_);
    table_.download(table.first(at(std::max(pages_, kept_pages_))));
    ring_.download(slots.first(capacity));
    places_.download(std::span(host_places_).first(capacity));
    std::size_t n = 0;
    auto const slot = [&](Index k) { return at((base_ + k) % reserved_); };
    for (Index k = 0; k < free_; ++k) ring[n++] = slots[slot(k)];
    for (Index k = free_; k < free_ + left_; ++k) {
      Page<V>* const page = slots[slot(k)];
      Index const place = host_places_[slot(k)];
      if (place < 0) {
        ring[n++] = page;
      } else {
        if (place < pages_) ring[n++] = table[at(place)];
        table[at(place)] = page;
      }
    }
    for (Index p = kept_pages_; p < pages_; ++p) ring[n++] = table[at(p)];
    pages_ = kept_pages_;
    size_ = kept_;
    base_ = left_ = 0;
    free_ = static_cast<Index>(n);
    ++now_;
    table_.upload(table.first(at(pages_)));
    ring_.upload(ring.first(n));
  }

 private:
  static constexpr std::size_t per_page = Page<V>::entries, per_batch = 256;  // pages

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index page_of(std::size_t entry) { return static_cast<Index>(entry / per_page); }
  static Index pages_for(std::size_t entries) { return page_of(entries + per_page - 1); }

  [[nodiscard]] detail::PageTables<V> tables() {
    return {table_.data(), ring_.data(), places_.data(), reserved_,
            own_.data(),   now_,         noted_.data()};
  }
  /// The slot of the first of so many free pages, which are not any more.
  Index take_free(Index count) {
    Index const first = base_;
    if (count > 0) base_ = (base_ + count) % reserved_;
    free_ -= count;
    return first;
  }
  /// Memory for so many pages more, and room for so many in all, with some for changes to come, so that nothing is lost where
  /// memory runs out.
  void reserve(B const& backend, Index more, Index in_all) {
    if (free_ < more) {
      Index const count = std::max({more - free_, reserved_ / 4, Index{16}}),
                  capacity = reserved_ + count;
      auto ring = unset<Page<V>*>(backend, at(capacity));
      auto places = unset<Index>(backend, at(capacity));
      host_ring_.resize(at(capacity));
      host_slots_.resize(at(capacity));
      host_places_.resize(at(capacity));
      auto& chunk = chunks_.emplace_back(unset<V>(backend, at(count) * per_page));
      backend.for_each(
          count + free_ + left_,
          detail::MoveRing<V>{tables(), base_, chunk.data(), count, ring.data(), places.data()});
      ring_ = std::move(ring);
      places_ = std::move(places);
      reserved_ = capacity;
      base_ = 0;
      free_ += count;
    }
    if (table_.size() >= at(in_all)) return;
    auto const room = at(in_all + in_all / 4 + 16);
    host_table_.resize(room);
    auto const longer = [&]<class U>(Array<U> const& array) {
      auto copy = zeros<U>(backend, room);
      detail::copy_values<B, U>(backend, array.data(), copy.data(), at(pages_));
      return copy;
    };
    auto table = longer(table_);
    auto own = longer(own_);
    auto noted = longer(noted_);
    table_ = std::move(table);
    own_ = std::move(own);
    noted_ = std::move(noted);
  }
  /// Listed pages, or those from one on, to a batch; so many entries, or as many as it holds.
  void gather(B const& backend, Index const* listed, Index first, Array<V>& batch,
              std::size_t entries) {
    Index const count = pages_for(std::min(entries, batch.size()));
    backend.for_each(count * static_cast<Index>(detail::PageWords<V>::each),
                     detail::GatherPages<V>{table_.data(), listed, first, batch.data()});
  }

  std::size_t size_ = 0, kept_ = 0;       // entries; and when it was kept
  Index pages_ = 0, kept_pages_ = 0;      // the same of pages
  Array<Page<V>*> table_;                 // (pages), and room
  Array<Index> own_;                      // by place: see detail::PageTables
  Array<std::uint8_t> noted_;             // by place
  Index now_ = 1;                         // the stamp of what is its own
  Array<Page<V>*> ring_;                  // (reserved): from base on those that are free, and left
  Array<Index> places_;                   // by slot
  Index base_ = 0, free_ = 0, left_ = 0;  // slots
  Index reserved_ = 0;                    // pages
  std::vector<Array<V>> chunks_;
  Array<Index> listed_;                                        // pages that are to be its own
  Array<Page<V>*> table_before_;                               // of the last replace_from
  std::vector<Page<V>*> host_table_, host_ring_, host_slots_;  // for take_back, which makes none
  std::vector<Index> host_places_;
};

}  // namespace pliant
