#pragma once

#include <cstddef>
#include <vector>

#include <pliant/topology/tree_cell.hpp>

namespace pliant::detail {

/// How many cells, edges, sides and nodes a tree had before some of its divisions, ascending. Numbers ascend from older to newer: what
/// came before a division does not know of what came with it or later, but for what cells have that were divided since, and sides at
/// which newer cells lie; and where elements have nodes between their corners, which may be newer than these.
class DivisionMarks {
 public:
  static constexpr std::size_t most = 64;

  [[nodiscard]] bool empty() const { return marks_.empty(); }
  /// Before a division. Of too many, each other one is forgotten.
  void add(TreeSizes const& now) {
    if (!marks_.empty() && marks_.back().cells == now.cells) marks_.pop_back();
    if (marks_.size() == most) {
      for (std::size_t k = 0; k < most / 2; ++k) marks_[k] = marks_[2 * k + 1];
      marks_.resize(most / 2);
    }
    marks_.push_back(now);
  }
  /// The last that came before all of some entries, of which `first` has the first of each kind; or `initial`.
  [[nodiscard]] TreeSizes last_before(TreeSizes const& first, TreeSizes const& initial) const {
    TreeSizes last = initial;
    for (TreeSizes const& own : marks_)
      if (own.cells <= first.cells && own.edges <= first.edges && own.sides <= first.sides &&
          own.nodes <= first.nodes)
        last = own;
    return last;
  }
  /// The same tree has others sizes now: renumber(sizes).
  template <class Renumber>
  void renumber(Renumber const& renumber_one) {
    for (TreeSizes& own : marks_) own = renumber_one(own);
  }
  /// Forgets those behind one.
  void forget_behind(TreeSizes const& last) {
    while (!marks_.empty() && marks_.back().cells > last.cells) marks_.pop_back();
  }

 private:
  std::vector<TreeSizes> marks_;
};

}  // namespace pliant::detail
