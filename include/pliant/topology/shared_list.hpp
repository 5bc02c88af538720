#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/topology/pages.hpp>

namespace pliant {

/// A list in pages that its copies share until one of them changes: to copy it takes as long as to copy a pointer per
/// page, and what a change costs is in proportion to the pages that it touches. Copies share groups of pages as a whole,
/// so that they count owners of groups alone. Copies may be used in several threads.
template <class V>
class SharedList {
 public:
  using value_type = V;
  class Iterator {
   public:
    using value_type = V;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(SharedList const& list, std::size_t i) : list_(&list), i_(i) {}
    V const& operator*() const { return (*list_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    Iterator operator++(int) { return std::exchange(*this, Iterator(*list_, i_ + 1)); }
    bool operator==(Iterator const& other) const { return i_ == other.i_; }

   private:
    SharedList const* list_ = nullptr;
    std::size_t i_ = 0;
  };

  SharedList() = default;
  explicit SharedList(std::vector<V> const& values) {
    extend(values.size());
    for (std::size_t first = 0; first < size_; first += per_page)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first),
                  std::min(per_page, size_ - first), table_[first / per_page]->values);
  }
  SharedList(SharedList const& other)
      : table_(other.table_), groups_(other.groups_), size_(other.size_) {
    for (Group* group : groups_) group->owners.fetch_add(1, std::memory_order_relaxed);
  }
  SharedList(SharedList&& other) noexcept { swap(other); }
  SharedList& operator=(SharedList other) noexcept {
    swap(other);
    return *this;
  }
  ~SharedList() { shrink(0); }
  friend bool operator==(SharedList const& one, SharedList const& other) {
    return std::ranges::equal(one, other);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }
  V const& operator[](std::size_t i) const { return pages()[i]; }
  /// The list as loops see it, until its size changes or a page becomes its own.
  [[nodiscard]] Pages<V> pages() const { return {table_.data()}; }
  /// An entry to be changed: one's own, whoever shared it. In a loop of several threads it has to be one's own already.
  V& edit(std::size_t i) {
    assert(!HostThreads::in_loop() || is_own(i / per_page));
    return own(i / per_page).values[i % per_page];
  }
  /// An entry that was edited since the last copy was made: several threads may ask for theirs at once.
  V& edited(std::size_t i) { return pages()[i]; }

  void push_back(V const& value) {
    if (size_ % per_page == 0) {
      extend(1);
      edited(size_ - 1) = value;
    } else {
      own(size_ / per_page).values[size_ % per_page] = value;
      ++size_;
    }
  }
  /// Appends entries that have no value until they are edited.
  void extend(std::size_t count) {
    if (size_ % per_page != 0) own(size_ / per_page);
    add_pages(size_ + count, [](std::size_t) { return OwnedPage::make(); });
    size_ += count;
  }
  /// Which entries are to be edited, for `own`: several threads may add to it at once.
  class Touched {
   public:
    explicit Touched(SharedList const& list) : pages_(list.table_.size()) {}
    void add(std::size_t i) { pages_[i / per_page].store(true, std::memory_order_relaxed); }

   private:
    friend SharedList;
    std::vector<std::atomic<bool>> pages_;
  };
  /// Makes these entries one's own, whoever shared them: then several threads may edit them at once, each another one.
  void own(Touched const& touched) {
    std::vector<std::size_t> found;
    for (std::size_t p = 0; p < table_.size(); ++p)
      if (touched.pages_[p].load(std::memory_order_relaxed)) found.push_back(p);
    for (auto const p : found) own_group(p / per_group);
    detail::for_each_on_host(static_cast<Index>(found.size()), few_pages,
                             [&](Index k) { own(found[static_cast<std::size_t>(k)]); });
  }
  /// edit(entry, k) for the entry of the k-th of the numbers, which are different ones, on the threads of the host.
  template <class Edit>
  void edit_listed(std::vector<Index> const& numbers, Edit const& edit_one) {
    auto const for_each = [&](auto const& f) {
      detail::for_each_on_host(static_cast<Index>(numbers.size()), 1024, [&](Index i) {
        auto const k = static_cast<std::size_t>(i);
        f(static_cast<std::size_t>(numbers[k]), k);
      });
    };
    Touched touched(*this);
    for_each([&](std::size_t i, std::size_t) { touched.add(i); });
    own(touched);
    for_each([&](std::size_t i, std::size_t k) { edit_one(edit(i), k); });
  }
  /// Puts `count` entries in the place of those from `first` on: make(k), which may read the list as it was.
  template <class Make>
  void replace_from(std::size_t first, std::size_t count, Make const& make) {
    SharedList others = *this;
    others.shrink(std::min(first / per_page * per_page, size_));
    others.add_pages(first + count, [&](std::size_t p) {
      auto* const page = OwnedPage::make();
      for (std::size_t i = p * per_page; i < std::min((p + 1) * per_page, first + count); ++i)
        page->values[i % per_page] = i < first ? (*this)[i] : make(i - first);
      return page;
    });
    others.size_ = first + count;
    swap(others);
  }
  /// Takes the entries from this one on away.
  void shrink(std::size_t size) {
    auto const pages = pages_for(size), groups = groups_for(pages);
    bool const cuts_group = pages < std::min(table_.size(), groups * per_group);
    if (cuts_group) own_group(groups - 1);  // before anything goes, as memory may run out
    for (; groups_.size() > groups; groups_.pop_back()) Group::release(groups_.back());
    for (auto p = pages; cuts_group && p < groups * per_group; ++p)
      if (auto* const page = std::exchange(groups_.back()->pages[p % per_group], nullptr))
        OwnedPage::release(page);
    table_.resize(std::min(pages, table_.size()));
    size_ = size;
  }
  void clear() { shrink(0); }
  /// Takes those entries from `first` on away for which not stays(place); the others move up.
  template <class Stays>
  void keep(std::size_t first, Stays const& stays) {
    std::size_t next = first;
    for (std::size_t i = first; i < size_; ++i) {
      if (!stays(i)) continue;
      if (next != i) edit(next) = (*this)[i];
      ++next;
    }
    shrink(next);
  }

 private:
  static constexpr std::size_t per_page = Page<V>::entries, per_group = 64;  // entries; pages
  static constexpr Index few_pages = 16;                                     // worth a thread

  /// A page that knows how many groups have it.
  struct OwnedPage : Page<V> {
    std::atomic<int> owners{1};

    static OwnedPage& of(Page<V>* page) { return *static_cast<OwnedPage*>(page); }
    static Page<V>* make() { return new OwnedPage; }
    static void release(Page<V>* page) {
      if (of(page).owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete &of(page);
    }
    [[nodiscard]] bool is_shared() const { return owners.load(std::memory_order_acquire) > 1; }
  };
  /// Pages side by side, and how many lists have them.
  struct Group {
    std::atomic<int> owners{1};
    std::array<Page<V>*, per_group> pages{};  // null behind the last

    static void release(Group* group) {
      if (group->owners.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
      for (Page<V>* page : group->pages)
        if (page != nullptr) OwnedPage::release(page);
      delete group;
    }
    [[nodiscard]] bool is_shared() const { return owners.load(std::memory_order_acquire) > 1; }
  };

  static std::size_t pages_for(std::size_t entries) { return (entries + per_page - 1) / per_page; }
  static std::size_t groups_for(std::size_t pages) { return (pages + per_group - 1) / per_group; }

  void swap(SharedList& other) noexcept {
    table_.swap(other.table_);
    groups_.swap(other.groups_);
    std::swap(size_, other.size_);
  }
  /// Puts make(page) behind the pages, for so many entries in all, on the threads of the host. Nothing has changed where that
  /// throws.
  template <class Make>
  void add_pages(std::size_t entries, Make const& make) {
    auto const first = table_.size(), needed = std::max(first, pages_for(entries));
    if (first < groups_.size() * per_group) own_group(groups_.size() - 1);
    try {
      table_.resize(needed, nullptr);
      groups_.reserve(groups_for(needed));
      while (groups_.size() < groups_for(needed)) groups_.push_back(new Group);
      detail::for_each_on_host(static_cast<Index>(needed - first), few_pages, [&](Index k) {
        auto const p = first + static_cast<std::size_t>(k);
        groups_[p / per_group]->pages[p % per_group] = table_[p] = make(p);
      });
    } catch (...) {
      shrink(size_);
      throw;
    }
  }
  [[nodiscard]] bool is_own(std::size_t p) const {
    return !groups_[p / per_group]->is_shared() && !OwnedPage::of(table_[p]).is_shared();
  }
  void own_group(std::size_t g) {
    if (!groups_[g]->is_shared()) return;
    auto* const copy = new Group;
    copy->pages = groups_[g]->pages;
    for (Page<V>* page : copy->pages)
      if (page != nullptr) OwnedPage::of(page).owners.fetch_add(1, std::memory_order_relaxed);
    Group::release(std::exchange(groups_[g], copy));
  }
  Page<V>& own(std::size_t p) {
    own_group(p / per_group);
    Page<V>*& page = table_[p];
    if (OwnedPage::of(page).is_shared()) {
      auto* const copy = OwnedPage::make();
      std::copy_n(page->values, per_page, copy->values);
      OwnedPage::release(std::exchange(page, copy));
      groups_[p / per_group]->pages[p % per_group] = copy;
    }
    return *page;
  }

  std::vector<Page<V>*> table_;  // of all groups, for loops
  std::vector<Group*> groups_;
  std::size_t size_ = 0;
};

}  // namespace pliant
