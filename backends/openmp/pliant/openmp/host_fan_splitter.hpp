#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/config.hpp>

namespace pliant::detail {

/// The most elements of a fan.
inline constexpr int most_host_fan_elements = 12;

/// Splits tetrahedra into fans: runs of elements around an edge, each of which shares a face with the next. Long fans come
/// first, as long as there are any, and among edges of as many elements those whose elements stand near each
/// other, as the parts of a cell do.
class HostFanSplitter {
 public:
  /// Calls keep(ends, ring, elements, size) for each fan of `count` elements with the nodes rows[4 · count]: element k of
  /// it has, up to an even permutation, the nodes at the places ends[0], ends[1], ring[k], ring[k + 1] of `rows`. All of
  /// that follows from which nodes are the same, and not from their numbers.
  template <class Keep>
  void split(Index const* rows, int count, Keep const& keep) {
    find_places(rows, count);
    find_edges(count);
    int left = count;
    for (int size = most_host_fan_elements; left > 0; --size)
      for (std::size_t k = 0; left > 0 && k < edges_of_[at(size)].size(); ++k) {  // which may grow
        int const edge = edges_of_[at(size)][k];
        int longest = find_longest(edge, size);
        if (longest == size) {
          take(edge, size, keep);
          left -= size;
          longest = find_longest(edge, size);
        }
        if (longest > 0) edges_of_[at(longest)].push_back(edge);
      }
  }

 private:
  static constexpr int most_around = 64;  // an edge; further elements wait for other edges
  struct Member {
    int element;
    int begin, end;  // the nodes beside the edge, turning about it one way
  };
  struct Edge {
    int low, high;           // nodes
    int first, last, count;  // elements
    int head, tail;          // of the list of sides
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  /// Nodes go by the places where they come first.
  void find_places(Index const* rows, int count) {
    auto const slots = std::bit_ceil(static_cast<unsigned>(8 * count));
    table_.assign(slots, -1);
    places_.resize(at(4 * count));
    for (int place = 0; place < 4 * count; ++place) {
      auto slot =
          (static_cast<std::uint64_t>(rows[place]) * 0x9E3779B97F4A7C15u >> 40) & (slots - 1);
      while (table_[slot] >= 0 && rows[table_[slot]] != rows[place])
        slot = (slot + 1) & (slots - 1);
      if (table_[slot] < 0) table_[slot] = place;
      places_[at(place)] = table_[slot];
    }
  }

  /// The nodes of an element with those of edge q first, ascending: an even permutation.
  std::array<int, 4> turned(int element, int q) const {
    static constexpr int corners[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                          {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
    int const* const row = places_.data() + 4 * element;
    auto const& c = corners[q];
    if (row[c[0]] <= row[c[1]]) return {row[c[0]], row[c[1]], row[c[2]], row[c[3]]};
    return {row[c[1]], row[c[0]], row[c[3]], row[c[2]]};
  }

  void find_edges(int count) {
    auto const slots = std::bit_ceil(static_cast<unsigned>(8 * count));
    table_.assign(slots, -1);
    edges_.clear();
    next_.resize(at(6 * count));
    is_taken_.assign(at(count), 0);
    for (auto& edges : edges_of_) edges.clear();
    for (int e = 0; e < count; ++e)
      for (int q = 0; q < 6; ++q) {
        auto const nodes = turned(e, q);
        Edge& edge = edge_of(nodes[0], nodes[1], e);
        int const side = 6 * e + q;
        edge.last = e;
        ++edge.count;
        (edge.tail < 0 ? edge.head : next_[at(edge.tail)]) = side;
        edge.tail = side;
        next_[at(side)] = -1;
      }
    for (bool near : {true, false})
      for (std::size_t k = 0; k < edges_.size(); ++k) {
        Edge const& edge = edges_[k];
        if ((edge.last - edge.first < 2 * edge.count) == near)
          edges_of_[at(std::min(edge.count, most_host_fan_elements))].push_back(
              static_cast<int>(k));
      }
  }
  Edge& edge_of(int low, int high, int element) {
    auto const mask = table_.size() - 1;
    auto const key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
    for (std::size_t slot = key * 0x9E3779B97F4A7C15u >> 40 & mask;; slot = (slot + 1) & mask) {
      if (table_[slot] < 0) {
        table_[slot] = static_cast<int>(edges_.size());
        return edges_.emplace_back(Edge{low, high, element, element, 0, -1, -1});
      }
      Edge& edge = edges_[at(table_[slot])];
      if (edge.low == low && edge.high == high) return edge;
    }
  }

  /// Puts the longest fan of elements around an edge that no fan has to the front of around_: how long it is. Where it is
  /// shorter than `size`, that is an upper bound.
  int find_longest(int e, int size) {
    int count = 0;
    for (int side = edges_[at(e)].head; side >= 0 && count < most_around; side = next_[at(side)]) {
      if (is_taken_[at(side / 6)] != 0) continue;
      if (count > 0 && around_[at(count - 1)].element == side / 6) continue;  // it has a node twice
      auto const nodes = turned(side / 6, side % 6);
      around_[at(count++)] = {side / 6, nodes[2], nodes[3]};
    }
    if (count < size) return count;
    int longest = 0, done = 0;
    std::array<Member, most_host_fan_elements> best;
    while (done < count) {
      int const length = chain(done, count);
      if (length > longest) {
        longest = std::min(length, most_host_fan_elements);
        std::copy_n(around_.begin() + done, longest, best.begin());
      }
      done += length;
    }
    std::copy_n(best.begin(), longest, around_.begin());
    return longest;
  }
  /// Orders members from `first` on such that a fan begins there: how long it is.
  int chain(int first, int count) {
    auto const begin = around_.begin();
    auto const follows_none = [&](Member const& m) {
      return std::none_of(begin + first, begin + count,
                          [&](Member const& other) { return other.end == m.begin; });
    };
    auto const start = std::find_if(begin + first, begin + count, follows_none);
    if (start != begin + count) std::iter_swap(begin + first, start);
    int last = first;
    while (last + 1 < count) {
      int const end = around_[at(last)].end;
      auto const next = std::find_if(begin + last + 1, begin + count,
                                     [&](Member const& m) { return m.begin == end; });
      if (next == begin + count) break;
      std::iter_swap(begin + ++last, next);
    }
    return last + 1 - first;
  }
  /// The fan that was found.
  template <class Keep>
  void take(int e, int size, Keep const& keep) {
    int const ends[2] = {edges_[at(e)].low, edges_[at(e)].high};
    int ring[most_host_fan_elements + 1], elements[most_host_fan_elements];
    ring[0] = around_[0].begin;
    for (int k = 0; k < size; ++k) {
      Member const& m = around_[at(k)];
      ring[k + 1] = m.end;
      elements[k] = m.element;
      is_taken_[at(m.element)] = 1;
    }
    keep(ends, ring, elements, size);
  }

  std::vector<int> table_;   // of places by a hash of their nodes, then of edges by one of theirs
  std::vector<int> places_;  // (elements, 4): the first that has the node
  std::vector<int> next_;    // (elements, 6)
  std::vector<Edge> edges_;
  std::vector<char> is_taken_;  // (elements)
  std::array<std::vector<int>, most_host_fan_elements + 1>
      edges_of_;  // by the longest fan there may be
  std::array<Member, most_around> around_;
};

}  // namespace pliant::detail
