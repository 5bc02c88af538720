#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/backend/patch_cuts.hpp>

namespace pliant::detail {

/// The nodes of the elements of a table, by the patch. After a change patches that stay have theirs where they were: those of a
/// table that was given as a whole are kept as long as one of its patches stays.
template <int Nodes>
class PatchConnectivity {
 public:
  using Row = std::array<Index, Nodes>;

  PatchConnectivity() = default;
  PatchConnectivity(std::vector<Row> rows, HostPatches const& cuts)
      : flat_(std::make_unique<Flat>()) {
    auto const all = std::make_shared<std::vector<Row> const>(std::move(rows));
    of_.resize(static_cast<std::size_t>(cuts.count()));
    for (Index p = 0; p < cuts.count(); ++p) of_[at(p)] = {all, all->data() + cuts.first(p)};
    is_flat_ = true;
  }
  /// `rows`: of blocks that do not stay, one after another; `known`: by the patch, that which it was before, or −1.
  PatchConnectivity(std::vector<Row> const& rows, HostPatches const& cuts,
                    ElementBlocks const& blocks, std::vector<Index> const& known,
                    PatchConnectivity const& before, HostPatches const& cuts_before)
      : flat_(std::make_unique<Flat>()) {
    of_.resize(known.size());
    for (std::size_t p = 0; p < known.size(); ++p)
      if (known[p] >= 0) of_[p] = before.of_[at(known[p])];
    auto const sources = sources_of(blocks);
    auto const pieces = pieces_of(cuts, blocks);
    for_each_on_host(static_cast<Index>(pieces.size()) - 1, few_pieces, [&](Index piece) {
      Index const first = pieces[at(piece)], last = pieces[at(piece) + 1];
      if (std::any_of(known.begin() + first, known.begin() + last, [](Index p) { return p < 0; }))
        carry(first, last, cuts, blocks, [&](std::size_t b) {
          return blocks.stays[b] != 0 ? before.row(cuts_before, blocks.first_before[b])
                                      : rows.data() + (-1 - sources[b]);
        });
    });
  }

  /// Of a patch; where it begins within a block, rows of the others of that block are in front of these.
  Row const* rows(Index patch) const { return of_[at(patch)].get(); }
  Row const* row(HostPatches const& cuts, Index e) const {
    Index const patch = cuts.ranges().patch_of(e);
    return rows(patch) + (e - cuts.first(patch));
  }
  /// Of all elements, one after another: put together when they are first asked for.
  Row const* flat(HostPatches const& cuts) const {
    if (of_.empty()) return nullptr;
    if (is_flat_) return rows(0);
    std::call_once(flat_->once, [&] {
      auto all = std::make_unique_for_overwrite<Row[]>(at(cuts.first().back()));
      for_each_on_host(cuts.count(), few_patches, [&](Index p) {
        std::copy_n(rows(p), cuts.first(p + 1) - cuts.first(p), all.get() + cuts.first(p));
      });
      flat_->rows = std::move(all);
    });
    return flat_->rows.get();
  }

 private:
  static constexpr Index few_patches = 4, few_pieces = 4;  // worth a thread
  struct Flat {
    std::once_flag once;
    std::unique_ptr<Row[]> rows;
  };
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// Runs of patches that begin and end where blocks do, as chapters do: the first patch of each, and how many there are.
  static std::vector<Index> pieces_of(HostPatches const& cuts, ElementBlocks const& blocks) {
    std::vector<Index> pieces{0};
    auto block = blocks.first.begin();
    for (Index p = 1; p <= cuts.count(); ++p) {
      while (*block < cuts.first(p)) ++block;
      if (*block == cuts.first(p)) pieces.push_back(p);
    }
    return pieces;
  }
  /// Puts rows of blocks one after another.
  template <class RowsOfBlock>
  void carry(Index first, Index last, HostPatches const& cuts, ElementBlocks const& blocks,
             RowsOfBlock const& rows_of_block) {
    Index const begin = cuts.first(first), end = cuts.first(last);
    std::shared_ptr<Row[]> const rows = std::make_unique_for_overwrite<Row[]>(at(end - begin));
    auto const& starts = blocks.first;
    auto b = at(static_cast<Index>(std::ranges::lower_bound(starts, begin) - starts.begin()));
    for (; b < blocks.stays.size() && starts[b] < end; ++b)
      if (starts[b + 1] > starts[b])
        std::copy_n(rows_of_block(b), starts[b + 1] - starts[b], rows.get() + (starts[b] - begin));
    for (Index p = first; p < last; ++p) of_[at(p)] = {rows, rows.get() + (cuts.first(p) - begin)};
  }

  std::vector<std::shared_ptr<Row const>> of_;  // (patches): its first row, and what keeps it
  bool is_flat_ = false;
  std::unique_ptr<Flat> flat_;  // where it is not
};

}  // namespace pliant::detail
