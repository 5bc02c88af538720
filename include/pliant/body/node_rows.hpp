#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// Which row of a body's fields belongs to each node. A node has its row as long as it is there: elements around which
/// nothing changes keep their rows of nodes, whatever a change of topology does elsewhere. Rows of nodes that go are free
/// until others take them; a free row has no mass, as that of a slave. Rows come in pages of nodes that lie near each other:
/// behind the first mesh's, a page belongs to a region of the mesh until all of its nodes are gone.
struct NodeRows {
  static constexpr Index page = 32;  ///< rows

  std::vector<Index> of_node;  ///< by the user's number
  std::vector<Index> node;     ///< by the row: the user's number; −1: the row is free
  std::vector<Index> region;   ///< by the page; −1: a free page; −2: of the first mesh

  [[nodiscard]] Index count() const { return static_cast<Index>(node.size()); }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("rows of nodes", r.of_node...);
    visit("nodes of rows", r.node...);
    visit("regions of pages", r.region...);
  }
};

namespace detail {

/// Gives rows to the nodes of another topology.
class ChangedNodeRows {
 public:
  template <int Dim>
  ChangedNodeRows(NodeRows const& before, Transfer<Dim> const& transfer) : rows_(before) {
    auto const pages = (rows_.node.size() + NodeRows::page - 1) / NodeRows::page;
    rows_.node.resize(pages * NodeRows::page, -1);
    rows_.region.resize(pages, -2);
    if (transfer.renumbers()) {
      rows_.of_node.resize(static_cast<std::size_t>(transfer.staying_nodes()));
      for (Index old = transfer.first_renumbered(); old < transfer.old_nodes(); ++old) {
        Index const row = before.of_node[static_cast<std::size_t>(old)],
                    now = transfer.renumbered(old);
        rows_.node[static_cast<std::size_t>(row)] = now;
        if (now >= 0)
          rows_.of_node[static_cast<std::size_t>(now)] = row;
        else
          freed_.push_back(row);
      }
    }
    rows_.of_node.resize(static_cast<std::size_t>(transfer.nodes()), -1);
    find_free();
  }

  /// Gives a node of a region a row, unless it has one.
  void give(Index node, Index region) {
    Index& row = rows_.of_node[static_cast<std::size_t>(node)];
    if (row >= 0) return;
    if (free_.size() <= static_cast<std::size_t>(region))
      free_.resize(static_cast<std::size_t>(region) + 1);
    auto& own = free_[static_cast<std::size_t>(region)];
    if (own.empty()) take_page(region, own);
    row = own.back();
    own.pop_back();
    rows_.node[static_cast<std::size_t>(row)] = node;
  }

  /// The rows, and those that were a node's and are free now.
  std::pair<NodeRows, std::vector<Index>> finish() && {
    while (!rows_.region.empty() && is_free(rows_.region.size() - 1)) {
      rows_.region.pop_back();
      rows_.node.resize(rows_.node.size() - NodeRows::page);
    }
    std::erase_if(freed_, [&](Index row) {
      return row >= rows_.count() || rows_.node[static_cast<std::size_t>(row)] >= 0;
    });
    return {std::move(rows_), std::move(freed_)};
  }

 private:
  [[nodiscard]] bool is_free(std::size_t page) const { return rows_.region[page] == -1; }
  /// Pages of which no row is taken any more, and the free rows of the others, by their regions: the first ones come last.
  void find_free() {
    for (auto page = static_cast<Index>(rows_.region.size()) - 1; page >= 0; --page) {
      Index& region = rows_.region[static_cast<std::size_t>(page)];
      if (region == -2) continue;
      auto const first = rows_.node.begin() + std::ptrdiff_t{NodeRows::page} * page;
      if (std::all_of(first, first + NodeRows::page, [](Index node) { return node < 0; })) {
        region = -1;
        free_pages_.push_back(page);
        continue;
      }
      if (free_.size() <= static_cast<std::size_t>(region))
        free_.resize(static_cast<std::size_t>(region) + 1);
      for (Index k = NodeRows::page - 1; k >= 0; --k)
        if (first[k] < 0)
          free_[static_cast<std::size_t>(region)].push_back(NodeRows::page * page + k);
    }
  }
  void take_page(Index region, std::vector<Index>& rows) {
    Index page = static_cast<Index>(rows_.region.size());
    if (free_pages_.empty()) {
      rows_.region.push_back(region);
      rows_.node.resize(rows_.node.size() + NodeRows::page, -1);
    } else {
      page = free_pages_.back();
      free_pages_.pop_back();
      rows_.region[static_cast<std::size_t>(page)] = region;
    }
    for (Index k = NodeRows::page - 1; k >= 0; --k) rows.push_back(NodeRows::page * page + k);
  }

  NodeRows rows_;
  std::vector<Index> freed_;
  std::vector<std::vector<Index>> free_;  // by the region
  std::vector<Index> free_pages_;
};

}  // namespace detail

}  // namespace pliant
