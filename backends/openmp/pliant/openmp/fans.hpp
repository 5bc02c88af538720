#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_array.hpp>
#include <pliant/openmp/host_fan_splitter.hpp>
#include <pliant/openmp/patch_rows.hpp>

namespace pliant::detail {

/// Consecutive elements of one group in a fan. Element k has the corners `ends`, ends + 1, ring + k, ring + k + 1.
struct FanRun {
  Index ends, ring;  // corners
  Index elements;    // the first, in the order of fans
  int size;
};

/// Tetrahedra in fans around edges, patch by patch: whoever works on a fan at once visits 3 + n nodes for n elements.
class Fans {
 public:
  Fans() = default;
  /// Of patches of patch_size elements with the nodes connectivity[4 · elements].
  Fans(Index const* connectivity, Index elements, Index patch_size, Index nodes)
      : patch_size_(patch_size),
        elements_(HostArray<Index>::unset(static_cast<std::size_t>(elements))) {
    auto const patches = static_cast<std::size_t>((elements + patch_size - 1) / patch_size);
    std::vector<std::vector<Index>> corners(patches);
    sizes_.resize(patches);
    HostParts const parts(static_cast<Index>(patches), few_patches);
    parts([&](Index from, Index to, int) {
      HostFanSplitter splitter;
      for (Index p = from; p < to; ++p) {
        Index const first = p * patch_size, count = std::min(patch_size, elements - first);
        auto& own = corners[static_cast<std::size_t>(p)];
        Index* element = elements_.data() + first;
        splitter.split(
            connectivity + std::ptrdiff_t{4} * first, count,
            [&](Index const* ends, Index const* ring, Index const* members, int size) {
              own.insert(own.end(), ends, ends + 2);
              own.insert(own.end(), ring, ring + size + 1);
              for (int k = 0; k < size; ++k) *element++ = first + members[k];
              sizes_[static_cast<std::size_t>(p)].push_back(static_cast<unsigned char>(size));
            });
      }
    });
    first_.push_back(0);
    for (auto const& own : corners)
      first_.push_back(first_.back() + static_cast<Index>(own.size()));
    nodes_ = HostArray<Index>::unset(static_cast<std::size_t>(first_.back()));
    for_each_on_host(static_cast<Index>(patches), few_patches, [&](Index p) {
      auto const k = static_cast<std::size_t>(p);
      std::ranges::copy(corners[k], nodes_.data() + first_[k]);
    });
    rows_ = PatchRows(
        nodes_, static_cast<Index>(patches),
        [&](Index p) { return std::ptrdiff_t{first_[static_cast<std::size_t>(p)]}; }, nodes);
    runs_.resize(patches);
    bounds_.resize(patches);
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

  template <class Visit>
  void for_each_fan(Index patch, Visit const& visit) const {
    Index corner = first_[static_cast<std::size_t>(patch)], element = patch * patch_size_;
    for (int const size : sizes_[static_cast<std::size_t>(patch)]) {
      visit(FanRun{corner, corner + 2, element, size});
      corner += size + 3;
      element += size;
    }
  }
  template <class Visit>
  void for_each_run(Index patch, Tag const* tags, Visit const& visit) const {
    for_each_fan(patch, [&](FanRun const& fan) {
      Index const* const members = elements_.data() + fan.elements;
      for (int from = 0, to = 0; from < fan.size; from = to) {
        Tag const tag = tags[members[from]];
        while (to < fan.size && tags[members[to]] == tag) ++to;
        visit(int{tag}, FanRun{fan.ends, fan.ring + from, fan.elements + from, to - from});
      }
    });
  }

  Index patch_size_ = 1;
  std::vector<Index> first_;                       // (patches + 1), corners
  HostArray<Index> nodes_, elements_;              // (corners), (elements)
  std::vector<std::vector<unsigned char>> sizes_;  // of the fans of each patch
  PatchRows rows_;                                 // of corners
  std::vector<std::vector<FanRun>> runs_;          // of each patch, by group
  std::vector<std::vector<Index>> bounds_;         // of each patch (groups + 1)
};

}  // namespace pliant::detail
