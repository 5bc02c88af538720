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
#include <pliant/math/unset_vector.hpp>
#include <pliant/topology/kept_pages.hpp>
#include <pliant/topology/page_copies.hpp>
#include <pliant/topology/pages.hpp>
#include <pliant/topology/shared_list.hpp>

namespace pliant {

/// A list in pages in a backend's memory, as SharedList is one on the host. Loops change entries in pages that are the
/// list's own since it was kept the last time: until it is kept again, all changes since then can be taken back. Pages that
/// nothing uses any more wait for others.
template <Backend B, class V>
class PagedList {
  template <class U>
  using Array = typename B::template Array<U>;
  using PutPages = detail::LoopStep<detail::PutFew<Page<V>*>>;

 public:
  PagedList() = default;
  /// With the entries of a list on the host.
  PagedList(B const& backend, SharedList<V> const& list) {
    extend(backend, list.size()).run(backend);
    UnsetVector<V> values;
    for (std::size_t first = 0; first < size_; first += per_batch * per_page) {
      values.resize(std::min(size_ - first, per_batch * per_page));
      detail::for_each_on_host(static_cast<Index>(pages_for(values.size())), 64, [&](Index p) {
        auto const from = static_cast<std::size_t>(p) * per_page;
        std::copy_n(&list[first + from], std::min(per_page, values.size() - from),
                    values.data() + from);
      });
      // The pages are those at the end of one chunk.
      auto& chunk = chunks_.front();
      chunk.upload(values, chunk.size() - pages_.size() * per_page + first);
    }
    keep();
    begin_noting();
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
    auto batch = unset<V>(backend, std::min(per_batch, pages_.size()) * per_page);
    for (std::size_t p = 0; p < pages_.size(); p += per_batch) {
      copy(backend, std::span(pages_.now()).subspan(p, std::min(per_batch, pages_.size() - p)),
           batch);
      batch.download(
          std::span(values).subspan(p * per_page, std::min(size_ - p * per_page, batch.size())));
    }
    return values;
  }

  /// A list on the host with the same entries. `like`: what the list was when it was made or began to note changes; pages that
  /// have not changed since then are shared with that.
  [[nodiscard]] SharedList<V> download(B const& backend, SharedList<V> const& like) {
    SharedList<V> list = like;
    if (list.size() > size_) list.shrink(size_);
    list.extend(size_ - list.size());
    std::vector<std::size_t> changed;
    for (std::size_t p = 0; p < pages_.size(); ++p)
      if (is_noted_[p] != 0) changed.push_back(p);
    auto batch = unset<V>(backend, std::min(per_batch, changed.size()) * per_page);
    std::vector<Page<V>*> pages;
    std::vector<V> values;
    for (std::size_t first = 0; first < changed.size(); first += per_batch) {
      std::span const some =
          std::span(changed).subspan(first, std::min(per_batch, changed.size() - first));
      pages.clear();
      for (auto const p : some) pages.push_back(pages_[p]);
      copy(backend, pages, batch);
      values.resize(some.size() * per_page);
      batch.download(values);
      for (std::size_t k = 0; k < some.size(); ++k) {
        auto const from = values.begin() + static_cast<std::ptrdiff_t>(k * per_page);
        std::copy_n(from, std::min(per_page, size_ - some[k] * per_page),
                    &list.edit(some[k] * per_page));
      }
    }
    return list;
  }
  /// Notes which pages change from now on, for that.
  void begin_noting() { is_noted_.assign(pages_.size(), 0); }

  /// Makes pages of which the byte is not zero the list's own; where these are most, the others too, which takes less than to
  /// list them.
  void change(B const& backend, std::span<std::uint8_t const> touched) {
    auto const count = touched.size() - static_cast<std::size_t>(std::ranges::count(touched, 0));
    if (pages_.is_kept() && count > detail::FewValues<Copied>::most &&
        4 * count > 3 * pages_.size())
      return change_all(backend);
    copied_.clear();
    detail::for_each_marked(touched, [&](std::size_t p) {
      is_noted_[p] = 1;
      if (!pages_.is_own(p)) copied_.push_back({static_cast<Index>(p), pages_[p], nullptr});
    });
    reserve(backend, copied_.size(), pages_.size());
    pages_.reserve_left(copied_.size());
    for (Copied& page : copied_) page.now = pages_.replace(static_cast<std::size_t>(page.place));
    copy(backend, copied_, table_.data());
  }
  /// Makes room for so many entries more, which have no value, beside those of the last page if that is shared with what was
  /// kept. Loops see it behind the step that this returns.
  [[nodiscard]] PutPages extend(B const& backend, std::size_t count) {
    auto const before = pages_.size(), needed = std::max(before, pages_for(size_ + count));
    reserve(backend, needed - before, needed);
    pages_.extend(needed);
    size_ += count;
    if (count > 0) note_from((size_ - count) / per_page);
    auto const pages = std::span(pages_.now()).subspan(before);
    auto* const to = table_.data() + before;
    PutPages step{};
    if (detail::with_few(pages, [&](auto const& few) {
          step = {static_cast<Index>(pages.size()), {few, to}};
        }))
      return step;
    table_.upload(pages, before);
    return step;
  }
  /// Puts `count` entries, which have no value, in the place of those from `first` on; those before stay. Gives the list as
  /// it was from there on, for loops that are asked for until it changes again.
  [[nodiscard]] Pages<V> replace_from(B const& backend, std::size_t first, std::size_t count) {
    auto const staying = first / per_page, needed = pages_for(first + count);
    auto const in_all = std::max(needed, pages_.size());
    reserve(backend, needed - staying, in_all);
    pages_.reserve_left(pages_.size() - staying);
    detail::grow(backend, table_before_, in_all);
    std::vector<Page<V>*> const left(pages_.now().begin() + static_cast<std::ptrdiff_t>(staying),
                                     pages_.now().end());
    copied_.clear();
    copied_.reserve(in_all - staying);
    pages_.cut(staying);
    pages_.extend(needed);
    for (std::size_t p = staying; p < std::max(needed, staying + left.size()); ++p)
      copied_.push_back({static_cast<Index>(p),
                         p - staying < left.size() ? left[p - staying] : nullptr,
                         p < needed ? pages_[p] : nullptr});
    for (std::size_t k = 0; k < left.size(); ++k) pages_.leave(staying + k, left[k]);
    size_ = first + count;
    note_from(staying);
    if (copied_.empty()) return {table_before_.data()};
    auto const listed = upload(backend, copied_);
    auto const places = static_cast<Index>(copied_.size());
    bool const keeps_entries = first % per_page != 0;  // of the first page that is left
    backend.for_each(keeps_entries ? std::max(places, detail::CopyPages<V>::words) : places,
                     detail::ReplacePages<V>{{listed.data(), nullptr},
                                             places,
                                             keeps_entries ? detail::CopyPages<V>::words : 0,
                                             table_.data(),
                                             table_before_.data()});
    return {table_before_.data()};
  }

  /// Keeps what changed.
  void keep() {
    pages_.keep();
    kept_ = size_;
  }
  /// The list is what it was when it was kept.
  void take_back(B const& backend) {
    is_noted_.resize(pages_.kept(), 1);
    pages_.take_back([&](std::size_t p) { is_noted_[p] = 1; });
    size_ = kept_;
    backend.synchronize();
    table_.upload(pages_.now());
  }

 private:
  using Copied = detail::CopiedPage<V>;
  static constexpr std::size_t per_page = Page<V>::entries, per_batch = 256;  // pages

  static std::size_t pages_for(std::size_t entries) { return (entries + per_page - 1) / per_page; }
  /// Notes that pages from a place on change.
  void note_from(std::size_t first) {
    is_noted_.resize(std::min(first, is_noted_.size()));
    is_noted_.resize(pages_.size(), 1);
  }
  /// Memory for so many pages more, and a table for so many in all, with some for changes to come, so that nothing is lost
  /// where memory runs out.
  void reserve(B const& backend, std::size_t more, std::size_t in_all) {
    pages_.reserve_places(in_all);
    if (pages_.free_pages() < more) {
      auto const count = std::max({more - pages_.free_pages(), reserved_ / 4, std::size_t{16}});
      auto& chunk = chunks_.emplace_back(unset<V>(backend, count * per_page));
      reserved_ += count;
      pages_.reserve(reserved_);
      for (std::size_t p = 0; p < count; ++p) pages_.add_free(page_in(chunk, p));
    }
    if (table_.size() >= in_all) return;
    auto table = zeros<Page<V>*>(backend, in_all + in_all / 4 + 16);
    backend.synchronize();  // loops may still read the one before
    table.upload(pages_.now());
    table_ = std::move(table);
  }
  /// Makes all pages, which are those that were kept, the list's own.
  void change_all(B const& backend) {
    auto const count = pages_.size();
    reserve(backend, count, count);
    pages_.reserve_all_left();
    detail::grow(backend, table_before_, count);
    table_before_.upload(pages_.next(count));
    pages_.replace_all();
    std::ranges::fill(is_noted_, 1);
    std::swap(table_, table_before_);
    copy_in_loops(backend, count, nullptr, [&](std::size_t first) {
      return detail::PagesOfTables<V>{table_before_.data(), table_.data(),
                                      static_cast<Index>(first)};
    });
  }
  static Page<V>* page_in(Array<V>& chunk, std::size_t p) {
    return reinterpret_cast<Page<V>*>(chunk.data() + p * per_page);
  }
  void copy(B const& backend, std::vector<Copied> const& copied, Page<V>** table) {
    using Copy = detail::CopyPages<V>;
    if (copied.empty() || detail::with_few(std::span<Copied const>(copied), [&](auto const& few) {
          using CopyFew = detail::CopyPages<V, detail::FewValues<Copied>>;
          backend.for_each(static_cast<Index>(copied.size()) * Copy::words, CopyFew{few, table});
        }))
      return;
    auto const listed = upload(backend, copied);
    copy_in_loops(backend, copied.size(), table,
                  [&](std::size_t first) { return listed.data() + first; });
  }
  /// Copies pages; list_from(k): those from the k-th on.
  template <class ListFrom>
  static void copy_in_loops(B const& backend, std::size_t pages, Page<V>** table,
                            ListFrom const& list_from) {
    using Copy = detail::CopyPages<V, decltype(list_from(std::size_t{}))>;
    for (std::size_t first = 0; first < pages; first += Copy::most_pages) {
      auto const count = static_cast<Index>(std::min<std::size_t>(pages - first, Copy::most_pages));
      backend.for_each(count * Copy::words, Copy{list_from(first), table});
    }
  }
  /// Copies pages to a batch, one behind the other.
  void copy(B const& backend, std::span<Page<V>* const> pages, Array<V>& batch) {
    std::vector<Copied> copies;
    for (std::size_t p = 0; p < pages.size(); ++p)
      copies.push_back({0, pages[p], page_in(batch, p)});
    copy(backend, copies, nullptr);
  }

  detail::KeptPages<V> pages_;
  std::size_t size_ = 0, kept_ = 0;  // entries; and when it was kept
  std::vector<std::uint8_t>
      is_noted_;                  // by place: whether a page changed since it began to note that
  std::vector<Copied> copied_;    // of a change
  Array<Page<V>*> table_;         // the same as pages_, and room
  Array<Page<V>*> table_before_;  // of the last replace_from, or before all pages changed
  std::vector<Array<V>> chunks_;
  std::size_t reserved_ = 0;  // pages
};

}  // namespace pliant
