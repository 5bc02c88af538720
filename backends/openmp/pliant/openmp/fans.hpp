#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_array.hpp>
#include <pliant/openmp/fan_block.hpp>
#include <pliant/openmp/patch_rows.hpp>

namespace pliant::detail {

/// Whether elements are of one group.
inline bool are_alike(Tag const* tags, Index count) {
  return count < 2 || std::equal(tags + 1, tags + count, tags);
}

/// Consecutive elements of one group in a fan. Element k has the corners `ends`, ends + 1, ring + k, ring + k + 1.
struct FanRun {
  Index ends, ring;  // corners
  Index elements;    // the first, in the order of fans
  int size;
};

/// Tetrahedra in fans around edges, patch by patch: whoever works on a fan at once visits 3 + n nodes for n elements. Fans
/// are those of blocks, cut where patches begin or end in them.
class Fans {
 public:
  Fans() = default;
  /// Of elements with the nodes connectivity[4 · elements], in patches: `bounds` has the first element of each, and how many
  /// there are. `before` has the blocks that stay.
  Fans(Index const* connectivity, std::vector<Index> const& bounds, Index nodes,
       ElementBlocks const& blocks = {}, Fans const* before = nullptr)
      : patches_(bounds),
        blocks_(connectivity, bounds.back(), blocks,
                before == nullptr ? nullptr : &before->blocks_),
        elements_(HostArray<Index>::unset(static_cast<std::size_t>(bounds.back()))) {
    auto const patches = static_cast<Index>(bounds.size()) - 1;
    first_.resize(static_cast<std::size_t>(patches) + 1);
    for_each_on_host(patches, few_patches, [&](Index p) {
      Index& corners = first_[static_cast<std::size_t>(p) + 1];
      for_each_block(
          p, [&](FanBlock const& own, Index) { corners += static_cast<Index>(own.corners.size()); },
          [&](FanBlock const&, Index, FanRun const& run) { corners += run.size + 3; });
    });
    for (std::size_t p = 1; p < first_.size(); ++p) first_[p] += first_[p - 1];
    nodes_ = HostArray<Index>::unset(static_cast<std::size_t>(first_.back()));
    sizes_.resize(static_cast<std::size_t>(patches));
    for_each_on_host(patches, few_patches, [&](Index p) { fill(p, connectivity); });
    rows_ = PatchRows(
        {nodes_.data(), nodes_.size()}, patches,
        [&](Index p) { return std::ptrdiff_t{first_[static_cast<std::size_t>(p)]}; }, nodes);
    runs_.resize(static_cast<std::size_t>(patches));
    bounds_.resize(static_cast<std::size_t>(patches));
  }

  /// By corner.
  Index const* nodes() const { return nodes_.data(); }
  Index const* targets() const { return rows_.targets(); }
  /// In the order of fans.
  Index const* elements() const { return elements_.data(); }
  PatchRows const& rows() const { return rows_; }

  /// What a patch has of a group, long runs first.
  std::span<FanRun const> runs(Index patch, int group) const {
    auto const p = static_cast<std::size_t>(patch), g = static_cast<std::size_t>(group);
    return {runs_[p].data() + bounds_[p][g], runs_[p].data() + bounds_[p][g + 1]};
  }
  /// Orders the runs of a patch by group.
  void order(Index patch, Tag const* tags, int groups) {
    auto const p = static_cast<std::size_t>(patch);
    std::vector<Index> next(static_cast<std::size_t>(groups * most_host_fan_elements) + 1);
    auto const place = [&](int group, int size) -> Index& {
      return next[static_cast<std::size_t>((group + 1) * most_host_fan_elements - size)];
    };
    for_each_run(patch, tags, [&](int group, FanRun const& run) {
      if (group < groups) ++place(group, run.size);
    });
    Index before = 0;
    for (Index& n : next) before += std::exchange(n, before);
    bounds_[p].clear();
    for (int g = 0; g < groups; ++g) bounds_[p].push_back(place(g, most_host_fan_elements));
    bounds_[p].push_back(before);
    runs_[p].resize(static_cast<std::size_t>(before));
    for_each_run(patch, tags, [&](int group, FanRun const& run) {
      if (group < groups) runs_[p][static_cast<std::size_t>(place(group, run.size)++)] = run;
    });
  }

  /// visit(element, k-th corner's place for k < 4) for all elements of a patch.
  template <class Visit>
  void for_each_element(Index patch, Visit const& visit) const {
    for_each_fan(patch, [&](FanRun const& fan) {
      for (int k = 0; k < fan.size; ++k)
        visit(elements_.data()[fan.elements + k],
              std::array<Index, 4>{fan.ends, fan.ends + 1, fan.ring + k, fan.ring + k + 1});
    });
  }

 private:
  static constexpr Index few_patches = 4;  // worth a thread

  Index first_element(Index patch) const { return patches_[static_cast<std::size_t>(patch)]; }

  /// Calls whole(block, its first element) for each block that a patch has all of, and cut(block, its first element, run)
  /// for what it has of the fans of others; corners and elements of the run are the block's.
  template <class Whole, class Cut>
  void for_each_block(Index patch, Whole const& whole, Cut const& cut) const {
    Index const begin = first_element(patch), end = first_element(patch + 1);
    blocks_.for_each_in(begin, end, [&](FanBlock const& block, Index first) {
      if (first >= begin && first + static_cast<Index>(block.elements.size()) <= end)
        return whole(block, first);
      FanRun run{0, 0, 0, 0};
      for (int const size : block.sizes) {
        auto const is_in = [&](int k) {
          Index const e = first + block.elements[static_cast<std::size_t>(run.elements + k)];
          return begin <= e && e < end;
        };
        for (int from = 0, to = 0; from < size; from = to) {
          bool const own = is_in(from);
          while (to < size && is_in(to) == own) ++to;
          if (own)
            cut(block, first,
                FanRun{run.ends, run.ends + 2 + from, run.elements + from, to - from});
        }
        run.ends += size + 3;
        run.elements += size;
      }
    });
  }
  void fill(Index patch, Index const* connectivity) {
    Index* node = nodes_.data() + first_[static_cast<std::size_t>(patch)];
    Index* element = elements_.data() + first_element(patch);
    auto& sizes = sizes_[static_cast<std::size_t>(patch)];
    for_each_block(
        patch,
        [&](FanBlock const& block, Index first) {
          Index const* const rows = connectivity + std::ptrdiff_t{4} * first;
          for (Index const corner : block.corners) *node++ = rows[corner];
          for (Index const e : block.elements) *element++ = first + e;
          sizes.insert(sizes.end(), block.sizes.begin(), block.sizes.end());
        },
        [&](FanBlock const& block, Index first, FanRun const& run) {
          Index const* const rows = connectivity + std::ptrdiff_t{4} * first;
          auto const add = [&](Index corner, int count) {
            for (int k = 0; k < count; ++k)
              *node++ = rows[block.corners[static_cast<std::size_t>(corner + k)]];
          };
          add(run.ends, 2);
          add(run.ring, run.size + 1);
          for (int k = 0; k < run.size; ++k)
            *element++ = first + block.elements[static_cast<std::size_t>(run.elements + k)];
          sizes.push_back(static_cast<unsigned char>(run.size));
        });
  }

  template <class Visit>
  void for_each_fan(Index patch, Visit const& visit) const {
    Index corner = first_[static_cast<std::size_t>(patch)], element = first_element(patch);
    for (int const size : sizes_[static_cast<std::size_t>(patch)]) {
      visit(FanRun{corner, corner + 2, element, size});
      corner += size + 3;
      element += size;
    }
  }
  template <class Visit>
  void for_each_run(Index patch, Tag const* tags, Visit const& visit) const {
    Index const first = first_element(patch);
    if (are_alike(tags + first, first_element(patch + 1) - first))
      return for_each_fan(patch, [&](FanRun const& fan) { visit(int{tags[first]}, fan); });
    for_each_fan(patch, [&](FanRun const& fan) {
      Index const* const members = elements_.data() + fan.elements;
      for (int from = 0, to = 0; from < fan.size; from = to) {
        Tag const tag = tags[members[from]];
        while (to < fan.size && tags[members[to]] == tag) ++to;
        visit(int{tag}, FanRun{fan.ends, fan.ring + from, fan.elements + from, to - from});
      }
    });
  }

  std::vector<Index> patches_;  // (patches + 1), elements
  FanBlocks blocks_;
  std::vector<Index> first_;                       // (patches + 1), corners
  HostArray<Index> nodes_, elements_;              // (corners), (elements)
  std::vector<std::vector<unsigned char>> sizes_;  // of the fans of each patch
  PatchRows rows_;                                 // of corners
  std::vector<std::vector<FanRun>> runs_;          // of each patch, by group
  std::vector<std::vector<Index>> bounds_;         // of each patch (groups + 1)
};

}  // namespace pliant::detail
