#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/backend.hpp>
#include <pliant/body/node_rows.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/tree_view.hpp>

// Passes that give rows to new nodes, for loops of a backend. Nodes are in the order of the leaves that they were made for,
// and those of a region, which is a run of blocks, get rows of its pages: the free ones of pages that it has, then those of
// further pages.
namespace pliant::detail {

/// The first of n ascending numbers that is not less than one.
template <class V>
PLIANT_HOST_DEVICE Index lower_place(V const* numbers, Index n, V wanted) {
  Index low = 0, high = n;
  while (low < high) {
    Index const middle = low + (high - low) / 2;
    if (numbers[middle] < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Keys by which new nodes are sorted: the place of the leaf that each was made for, or of that one's first child.
struct KeysOfNodes {
  TreeView tree;
  PlacedNode const* made;
  Index const* places;  // of leaves
  std::uint64_t* keys;
  Index* order;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = made[i].cell, child = tree.cells[static_cast<std::size_t>(cell)].first_child;
    keys[i] = static_cast<std::uint64_t>(places[child >= 0 ? child : cell]);
    order[i] = i;
  }
};

/// Whether a page is free: frees one of a region that has no node any more.
struct FreesPage {
  Index const* node;
  Index* region;
  PLIANT_HOST_DEVICE bool operator()(Index page) const {
    if (region[page] < 0) return region[page] == -1;
    for (Index k = 0; k < NodeRows::page; ++k)
      if (node[NodeRows::page * page + k] >= 0) return false;
    region[page] = -1;
    return true;
  }
};
/// Whether a page of a region has free rows.
struct HasFreeRows {
  Index const* node;
  Index const* region;
  PLIANT_HOST_DEVICE bool operator()(Index page) const {
    if (region[page] < 0) return false;
    for (Index k = 0; k < NodeRows::page; ++k)
      if (node[NodeRows::page * page + k] < 0) return true;
    return false;
  }
};
/// Keys by which listed pages are sorted: their regions; behind the list, so many as there are of these.
struct KeysOfPages {
  Index const* region;
  Index const* pages;
  Index const* listed;  // how many
  Index regions;
  std::uint64_t* keys;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    keys[i] = static_cast<std::uint64_t>(i < *listed ? region[pages[i]] : regions);
  }
};
/// How many rows of a page are free; none behind the list.
struct FreeRowsIn {
  Index const* node;
  Index const* pages;
  Index const* listed;
  PLIANT_HOST_DEVICE Index operator()(Index i) const {
    if (i >= *listed) return 0;
    Index count = 0;
    for (Index k = 0; k < NodeRows::page; ++k) count += node[NodeRows::page * pages[i] + k] < 0;
    return count;
  }
};

/// New nodes and pages with free rows, both in the order of regions.
struct NewRows {
  Index nodes, pages;                     // pages: at most
  std::uint64_t const* places;            // (nodes): see KeysOfNodes
  std::uint64_t const* regions_of_pages;  // (pages)
  Index const* free_before;               // (pages + 1): free rows of the pages before
  Index const* first_of_block;            // places, (blocks + 1)
  Index blocks, blocks_of_region;

  /// Of a region, the first of its nodes.
  [[nodiscard]] PLIANT_HOST_DEVICE Index first_node(Index region) const {
    Index const block = min(region * blocks_of_region, blocks);
    return lower_place(places, nodes, static_cast<std::uint64_t>(first_of_block[block]));
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index first_page(Index region) const {
    return lower_place(regions_of_pages, pages, static_cast<std::uint64_t>(region));
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index region_of(Index node) const {
    auto const place = static_cast<Index>(places[node]);
    Index const block = lower_place(first_of_block, blocks + 1, place + 1) - 1;
    return block / blocks_of_region;
  }
  /// How many free rows its pages have.
  [[nodiscard]] PLIANT_HOST_DEVICE Index free_rows(Index region) const {
    return free_before[first_page(region + 1)] - free_before[first_page(region)];
  }
};
/// How many pages more a region needs.
struct PagesNeeded {
  NewRows rows;
  PLIANT_HOST_DEVICE Index operator()(Index region) const {
    Index const left =
        rows.first_node(region + 1) - rows.first_node(region) - rows.free_rows(region);
    return left <= 0 ? 0 : (left + NodeRows::page - 1) / NodeRows::page;
  }
};
/// The page that a new one in the order of regions is: free ones come first.
struct PageAt {
  Index const* free_pages;
  Index free, pages;
  PLIANT_HOST_DEVICE Index operator()(Index i) const {
    return i < free ? free_pages[i] : pages + i - free;
  }
};
/// Gives pages to regions; `before`: how many the regions before need.
struct TakePages {
  PageAt page_at;
  Index const* before;
  Index regions;
  Index* region;
  Index* node;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const page = page_at(i);
    region[page] = lower_place(before, regions + 1, i + 1) - 1;
    for (Index k = 0; k < NodeRows::page; ++k) node[NodeRows::page * page + k] = -1;
  }
};
/// Finds a row for each new node, before any is taken.
struct FindRows {
  NewRows rows;
  Index const* node;
  Index const* pages;  // with free rows, in the order of regions
  PageAt page_at;
  Index const* before;  // see TakePages
  Index* found;         // by new nodes in the order of regions

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const region = rows.region_of(i), k = i - rows.first_node(region),
                free = rows.free_rows(region);
    if (k >= free) {
      Index const next = k - free;
      found[i] =
          NodeRows::page * page_at(before[region] + next / NodeRows::page) + next % NodeRows::page;
      return;
    }
    Index const wanted = rows.free_before[rows.first_page(region)] + k,
                among = lower_place(rows.free_before, rows.pages + 1, wanted + 1) - 1;
    Index left = wanted - rows.free_before[among], row = NodeRows::page * pages[among];
    for (; left > 0 || node[row] >= 0; ++row)
      if (node[row] < 0) --left;
    found[i] = row;
  }
};
struct TakeFoundRows {
  Index const* found;
  Index const* order;
  PlacedNode const* made;
  Index* of_node;
  Index* node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const own = made[order[i]].node;
    of_node[own] = found[i];
    node[found[i]] = own;
  }
};

/// Which of the nodes from a first one on go, by their new numbers.
struct GoesAway {
  Index const* numbers;
  PLIANT_HOST_DEVICE Index operator()(Index k) const { return numbers[k] < 0 ? 1 : 0; }
};
/// Lists the rows of those that go.
struct ListFreed {
  GoesAway goes;
  Index const* before;   // how many of the nodes before each go
  Index const* of_node;  // by old numbers, from the same first node on
  Index* freed;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (goes(k) != 0) freed[before[k]] = of_node[k];
  }
};
/// Gives nodes that moved up the rows they had; rows of those that go are free.
struct MoveRows {
  NewNumbers numbers;
  Index const* of_node;  // by old numbers
  Index* node;
  Index* moved;  // rows by new numbers, from the same first node on

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const now = numbers.others[k], row = of_node[numbers.first + k];
    node[row] = now;
    if (now >= 0) moved[now - numbers.first] = row;
  }
};

}  // namespace pliant::detail
