#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/topology/cell_set.hpp>

namespace pliant {

/// The cells of a tree that the elements of a block are, in the order that a body keeps.
struct BlockCells {
  std::vector<Index> cells;
  Index greatest = -1;

  void add(Index c) {
    cells.push_back(c);
    greatest = std::max(greatest, c);
  }
};

/// The user's numbers of the elements of a type, by the internal number. Of a tree, they are found from the cells when all of
/// them are asked for, once.
class ElementNumbers {
 public:
  using Blocks = std::vector<std::shared_ptr<BlockCells const>>;

  ElementNumbers() = default;
  explicit ElementNumbers(std::vector<Index> numbers)
      : size_(numbers.size()), made_(std::make_shared<Made>(std::move(numbers))) {}
  /// Of elements that are in blocks, which begin at `first`; the element of a cell has its place in the set.
  ElementNumbers(Blocks blocks, std::vector<Index> first, CellSet set)
      : size_(static_cast<std::size_t>(first.back())),
        blocks_(std::move(blocks)),
        first_(std::move(first)),
        set_(std::move(set)),
        made_(std::make_shared<Made>(std::vector<Index>{})) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  /// What blocks of a tree's elements are; empty where numbers were given.
  [[nodiscard]] Blocks const& blocks() const { return blocks_; }
  [[nodiscard]] std::vector<Index> const& all() const {
    if (!blocks_.empty()) std::call_once(made_->once, [&] { find(made_->numbers); });
    return made_->numbers;
  }
  /// Of one element, without a look at the others.
  Index operator[](Index element) const {
    if (blocks_.empty()) return made_->numbers[static_cast<std::size_t>(element)];
    auto const block =
        static_cast<std::size_t>(std::ranges::upper_bound(first_, element) - first_.begin() - 1);
    return set_.rank(blocks_[block]->cells[static_cast<std::size_t>(element - first_[block])]);
  }

 private:
  void find(std::vector<Index>& numbers) const {
    numbers.resize(size_);
    constexpr Index few_blocks = 16;  // worth a thread
    detail::for_each_on_host(static_cast<Index>(blocks_.size()), few_blocks, [&](Index block) {
      auto const b = static_cast<std::size_t>(block);
      std::ranges::transform(blocks_[b]->cells, numbers.begin() + first_[b],
                             [&](Index c) { return set_.rank(c); });
    });
  }

  struct Made {
    explicit Made(std::vector<Index> given) : numbers(std::move(given)) {}
    std::once_flag once;
    std::vector<Index> numbers;
  };
  std::size_t size_ = 0;
  Blocks blocks_;
  std::vector<Index> first_;  // (blocks + 1), elements
  CellSet set_;
  std::shared_ptr<Made> made_ = std::make_shared<Made>(std::vector<Index>{});
};

}  // namespace pliant
