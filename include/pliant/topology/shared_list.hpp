#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>

namespace pliant {

/// A list in blocks that its copies share until one of them changes: to copy it takes as long as to copy a pointer per
/// block, and what a change costs is in proportion to the blocks that it touches. Copies may be used in several threads.
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
  explicit SharedList(std::vector<V> const& values) : size_(values.size()) {
    for (std::size_t first = 0; first < size_; first += per_block) {
      auto const& block = blocks_.emplace_back(std::make_shared<Block>());
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first),
                  std::min(per_block, size_ - first), block->values.begin());
    }
  }
  friend bool operator==(SharedList const& one, SharedList const& other) {
    return std::ranges::equal(one, other);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }
  V const& operator[](std::size_t i) const { return blocks_[i / per_block]->values[i % per_block]; }
  /// An entry to be changed: one's own, whoever shared it. In a loop of several threads it has to be one's own already.
  V& edit(std::size_t i) {
    assert(!HostThreads::in_loop() || blocks_[i / per_block].use_count() == 1);
    return own(i / per_block).values[i % per_block];
  }
  /// An entry that was edited since the last copy was made: several threads may ask for theirs at once.
  V& edited(std::size_t i) { return blocks_[i / per_block]->values[i % per_block]; }

  void push_back(V const& value) {
    if (size_ % per_block == 0) blocks_.push_back(std::make_shared<Block>());
    own(size_ / per_block).values[size_ % per_block] = value;
    ++size_;
  }
  /// Appends entries that have no value until they are edited.
  void extend(std::size_t count) {
    auto const first_new = blocks_.size();
    if (size_ % per_block != 0) own(first_new - 1);
    size_ += count;
    blocks_.resize((size_ + per_block - 1) / per_block);
    for_each_block(first_new, [&](std::size_t b) { blocks_[b] = std::make_shared<Block>(); });
  }
  /// Which entries are to be edited, for `own`: several threads may add to it at once.
  class Touched {
   public:
    explicit Touched(SharedList const& list) : blocks_(list.blocks_.size()) {}
    void add(std::size_t i) { blocks_[i / per_block].store(true, std::memory_order_relaxed); }

   private:
    friend SharedList;
    std::vector<std::atomic<bool>> blocks_;
  };
  /// Makes these entries one's own, whoever shared them: then several threads may edit them at once, each another one.
  void own(Touched const& touched) {
    std::vector<std::size_t> found;
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      if (touched.blocks_[b].load(std::memory_order_relaxed)) found.push_back(b);
    detail::for_each_on_host(static_cast<Index>(found.size()), few_blocks,
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
    SharedList others;
    auto const kept = first / per_block;
    others.size_ = first + count;
    others.blocks_.resize((others.size_ + per_block - 1) / per_block);
    std::copy_n(blocks_.begin(), std::min(kept, others.blocks_.size()), others.blocks_.begin());
    others.for_each_block(kept, [&](std::size_t b) {
      auto block = std::make_shared<Block>();
      for (std::size_t i = b * per_block; i < std::min((b + 1) * per_block, others.size_); ++i)
        block->values[i % per_block] = i < first ? (*this)[i] : make(i - first);
      others.blocks_[b] = std::move(block);
    });
    *this = std::move(others);
  }
  /// Takes the entries from this one on away.
  void shrink(std::size_t size) {
    size_ = size;
    blocks_.resize((size + per_block - 1) / per_block);
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
  static constexpr std::size_t per_block = 256;
  static constexpr Index few_blocks = 16;  // worth a thread
  static_assert(std::is_trivially_copyable_v<V>);
  union Block {  // without values, at first
    Block() {}
    Block(Block const& other) : values(other.values) {}
    std::array<V, per_block> values;
  };

  /// Of blocks from this one on, on the threads of the host.
  template <class F>
  void for_each_block(std::size_t first, F const& f) const {
    auto const count = blocks_.size() - std::min(first, blocks_.size());
    detail::for_each_on_host(static_cast<Index>(count), few_blocks,
                             [&](Index b) { f(first + static_cast<std::size_t>(b)); });
  }
  Block& own(std::size_t b) {
    if (blocks_[b].use_count() > 1) blocks_[b] = std::make_shared<Block>(*blocks_[b]);
    return *blocks_[b];
  }

  std::vector<std::shared_ptr<Block>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace pliant
