#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/body/awake_set.hpp>
#include <pliant/math/group_by_key.hpp>

// Which nodes belong to which patches, and into which pieces these fall.
namespace pliant::detail {

/// The pieces that some nodes, sorted, fall into, of which elements join some to one.
class Pieces {
 public:
  explicit Pieces(std::vector<Index> nodes) : nodes_(std::move(nodes)), joined_(nodes_.size()) {
    std::iota(joined_.begin(), joined_.end(), std::size_t{0});
  }
  void join(Index node, Index other) { joined_[root(place(node))] = root(place(other)); }
  /// f(node, piece), pieces numbered in the order of their first nodes; returns how many there are.
  template <class F>
  Index for_each_node(F const& f) {
    Index count = 0;
    std::vector<Index> numbers(nodes_.size(), -1);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      auto& number = numbers[root(i)];
      if (number < 0) number = count++;
      f(nodes_[i], number);
    }
    return count;
  }

 private:
  std::size_t place(Index node) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(nodes_, node) - nodes_.begin());
  }
  std::size_t root(std::size_t i) {
    while (joined_[i] != i) i = joined_[i] = joined_[joined_[i]];
    return i;
  }
  std::vector<Index> nodes_;
  std::vector<std::size_t> joined_;
};

struct PairedRows {
  std::vector<Index> first{0}, others;
};
/// Which of `count` things share a row with each, itself left out, each once. Row i: things[first[i]] on.
inline PairedRows rows_beside(std::span<Index const> first, std::span<Index const> things,
                              std::size_t count) {
  std::vector<std::vector<Index>> beside(count);
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    auto const row = things.subspan(static_cast<std::size_t>(first[i]),
                                    static_cast<std::size_t>(first[i + 1] - first[i]));
    for (Index a : row)
      for (Index b : row)
        if (a != b) beside[static_cast<std::size_t>(a)].push_back(b);
  }
  PairedRows rows;
  for (auto& list : beside) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
    rows.others.insert(rows.others.end(), list.begin(), list.end());
    rows.first.push_back(static_cast<Index>(rows.others.size()));
  }
  return rows;
}

template <class Parts>
std::size_t patch_count(Parts& parts) {
  std::size_t count = 0;
  parts.for_each_type(
      [&](auto& table, auto&) { count += static_cast<std::size_t>(table.elements.patch_count()); });
  return count;
}

/// The nodes of a patch, ascending, and the piece of the patch that each lies in.
struct PiecesOfPatch {
  std::vector<Index> nodes, pieces;
  Index count = 0;  // of pieces
};

/// Elements by the rows of their nodes, and rows of slaves with their masters, copied from a backend's memory.
struct PatchSources {
  std::vector<Index> rows;  // (elements, width)
  std::size_t width = 0;
  std::vector<Index> slave_at, first, masters;  // slave_at: by row, which slave is there; −1: none
  std::size_t in_all = 0;                       // nodes of elements of all types

  [[nodiscard]] std::size_t connectivity_size() const { return in_all; }
  /// The nodes of the elements of a patch, `nodes` of each.
  [[nodiscard]] PiecesOfPatch patch(Index first_element, Index last_element, int nodes) const {
    // f(first node of an element, node)
    auto const for_each_node = [&](auto const& f) {
      for (Index e = first_element; e < last_element; ++e) {
        Index const* const own = rows.data() + width * static_cast<std::size_t>(e);
        for (int a = 0; a < nodes; ++a) {
          f(own[0], own[a]);
          Index const slave = slave_at[static_cast<std::size_t>(own[a])];
          for (Index k = slave < 0 ? 0 : first[static_cast<std::size_t>(slave)];
               slave >= 0 && k < first[static_cast<std::size_t>(slave) + 1]; ++k)
            f(own[0], masters[static_cast<std::size_t>(k)]);
        }
      }
    };
    PiecesOfPatch of_patch;
    for_each_node([&](Index, Index node) { of_patch.nodes.push_back(node); });
    std::ranges::sort(of_patch.nodes);
    of_patch.nodes.erase(std::unique(of_patch.nodes.begin(), of_patch.nodes.end()),
                         of_patch.nodes.end());
    Pieces pieces(of_patch.nodes);
    for_each_node([&](Index joined, Index node) { pieces.join(joined, node); });
    of_patch.count =
        pieces.for_each_node([&](Index, Index piece) { of_patch.pieces.push_back(piece); });
    return of_patch;
  }
};

/// Of all elements of a body; rows of elements are left out.
template <class Parts>
PatchSources patch_sources(Parts const& parts) {
  PatchSources sources;
  sources.slave_at.resize(static_cast<std::size_t>(parts.layout.rows), -1);
  parts.for_each_type([&](auto const& table, auto const&) {
    sources.in_all +=
        static_cast<std::size_t>(std::remove_cvref_t<decltype(table)>::element::nodes) *
        static_cast<std::size_t>(table.count());
  });
  auto const& slaves = parts.layout.interpolation.slaves();
  if (slaves.count == 0) return sources;
  auto const node = download<Index>(slaves.node);
  for (Index k = 0; k < slaves.count; ++k)
    sources.slave_at[static_cast<std::size_t>(node[static_cast<std::size_t>(k)])] = k;
  sources.first = download<Index>(slaves.first);
  sources.masters = download<Index>(slaves.other);
  return sources;
}

/// The patches of a body's elements, by internal numbers; from what is in the backend's memory.
template <class Parts>
PatchNodes<typename Parts::backend_type> make_patch_nodes(Parts& parts) {
  using B = typename Parts::backend_type;
  PatchNodes<B> made;
  auto const& layout = parts.layout;
  std::vector<Index> nodes_of_pairs, pieces_of_pairs, first_other;
  made.patch_of_piece.resize(patch_count(parts));
  std::iota(made.patch_of_piece.begin(), made.patch_of_piece.end(), Index{0});
  made.first_of_type = made.first_run = {0};
  auto sources = patch_sources(std::as_const(parts));
  HostThreads const threads(parts.backend, sources);
  parts.for_each_type([&](auto& table, auto&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const rows = table.elements.rows_of_nodes();
    sources.width = static_cast<std::size_t>(rows.width);
    auto copy =
        zeros<Index>(parts.backend, sources.width * static_cast<std::size_t>(table.count()));
    copy_values<B, Index>(parts.backend, rows.nodes, copy.data(), copy.size());
    sources.rows = download<Index>(copy);
    Index const before = made.first_of_type.back(), count = table.elements.patch_count();
    auto const bounds = table.elements.patch_bounds();
    std::vector<PiecesOfPatch> of_patches(static_cast<std::size_t>(count));
    for_each_on_host(count, 16, [&](Index p) {
      auto const own = static_cast<std::size_t>(p);
      of_patches[own] = sources.patch(bounds[own], bounds[own + 1], E::nodes);
    });
    for (Index p = 0; p < count; ++p) {
      auto const& own = of_patches[static_cast<std::size_t>(p)];
      std::vector<Index> runs;
      for (Index const node : own.nodes) runs.push_back(node / nodes_of_run);
      made.runs.insert(made.runs.end(), runs.begin(), std::unique(runs.begin(), runs.end()));
      made.first_run.push_back(static_cast<Index>(made.runs.size()));
      Index const patch = before + p, others = made.pieces_count() - 1;
      first_other.push_back(made.pieces_count());
      nodes_of_pairs.insert(nodes_of_pairs.end(), own.nodes.begin(), own.nodes.end());
      for (Index const piece : own.pieces)
        pieces_of_pairs.push_back(piece == 0 ? patch : others + piece);
      made.patch_of_piece.insert(made.patch_of_piece.end(), static_cast<std::size_t>(own.count - 1),
                                 patch);
    }
    made.first_of_type.push_back(before + count);
  });
  first_other.push_back(made.pieces_count());
  auto const by_node = group_by_key(nodes_of_pairs, layout.rows);
  made.first_of_node = by_node.first;
  for (Index pair : by_node.order)
    made.pieces_of_node.push_back(pieces_of_pairs[static_cast<std::size_t>(pair)]);

  auto const beside =
      rows_beside(made.first_of_node, made.pieces_of_node, made.patch_of_piece.size());
  auto of_patches = made.pieces_of_node;
  for (Index& piece : of_patches) piece = made.patch_of_piece[static_cast<std::size_t>(piece)];
  auto rows =
      made.pieces_count() == made.count()
          ? beside
          : rows_beside(made.first_of_node, of_patches, static_cast<std::size_t>(made.count()));
  made.first_neighbour = std::move(rows.first);
  made.neighbours = std::move(rows.others);
  made.first = upload(parts.backend, made.first_of_node);
  made.pieces = upload(parts.backend, made.pieces_of_node);
  made.patch = upload(parts.backend, made.patch_of_piece);
  made.first_beside = upload(parts.backend, beside.first);
  made.beside = upload(parts.backend, beside.others);
  made.first_other = upload(parts.backend, first_other);
  made.driven = zeros<std::uint8_t>(parts.backend, made.patch_of_piece.size());
  made.stirred = zeros<std::uint8_t>(parts.backend, made.patch_of_piece.size());
  made.turns = zeros<std::uint8_t>(parts.backend, static_cast<std::size_t>(made.count()));
  return made;
}

}  // namespace pliant::detail
