#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

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
                  std::min(per_block, size_ - first), block->begin());
    }
  }
  friend bool operator==(SharedList const& one, SharedList const& other) {
    return std::ranges::equal(one, other);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }
  V const& operator[](std::size_t i) const { return (*blocks_[i / per_block])[i % per_block]; }
  /// An entry to be changed: one's own, whoever shared it.
  V& edit(std::size_t i) { return own(i / per_block)[i % per_block]; }

  void push_back(V const& value) {
    if (size_ % per_block == 0) blocks_.push_back(std::make_shared<Block>());
    own(size_ / per_block)[size_ % per_block] = value;
    ++size_;
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
  using Block = std::array<V, per_block>;

  Block& own(std::size_t b) {
    if (blocks_[b].use_count() > 1) blocks_[b] = std::make_shared<Block>(*blocks_[b]);
    return *blocks_[b];
  }

  std::vector<std::shared_ptr<Block>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace pliant
