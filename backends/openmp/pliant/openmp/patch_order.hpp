#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <pliant/openmp/fan_list.hpp>

namespace pliant::detail {

/// The elements of a patch by group, in terms of the patch.
class PatchOrder {
 public:
  /// Elements, at most.
  static constexpr Index largest = 2048;

  /// Whether this is the order of elements with these tags.
  bool is_of(Tag const* tags, Index count) const {
    return is_alike_ ? count == 0 || (tags[0] == tag_ && are_alike(tags, count))
                     : std::equal(tags, tags + count, mixed_->tags.begin(), mixed_->tags.end());
  }
  /// Orders `count` elements, stably. Patches of one group have nothing to order, and keep what they were ordered to when
  /// they were mixed last, for when they are so again. `fans`: null where there are none.
  void order(Tag const* tags, Index count, int groups, FanList const* fans) {
    is_alike_ = are_alike(tags, count);
    size_ = static_cast<std::size_t>(count);
    tag_ = count == 0 ? Tag(0) : tags[0];
    if (!is_alike_ && (mixed_ == nullptr || !is_of(tags, count)))
      mixed_ = std::make_shared<Mixed>(tags, count, groups, fans);
  }

  /// Ascending.
  std::span<std::uint16_t const> members(int group) const {
    if (!is_alike_) {
      auto const* const bounds = mixed_->bounds.data() + group;
      return {mixed_->members.data() + bounds[0], mixed_->members.data() + bounds[1]};
    }
    return {all.data(), tag_ == group ? size_ : 0};
  }
  /// Long ones first.
  std::span<FanRun const> runs(int group, FanList const& fans) const {
    if (!is_alike_) return mixed_->runs.of(group);
    if (tag_ != group) return {};
    return fans.runs.of(0);
  }

 private:
  struct Mixed {
    std::vector<Tag> tags;
    std::vector<std::uint16_t> members;  // by group
    std::vector<std::size_t> bounds;     // (groups + 1), of members
    FanRuns runs;

    Mixed(Tag const* first, Index count, int groups, FanList const* fans)
        : tags(first, first + count) {
      members.reserve(tags.size());
      for (int g = 0; g < groups; ++g) {
        bounds.push_back(members.size());
        for (std::size_t e = 0; e < tags.size(); ++e)
          if (tags[e] == g) members.push_back(static_cast<std::uint16_t>(e));
      }
      bounds.push_back(members.size());
      if (fans != nullptr) runs = fans->by_group(first, groups);
    }
  };
  static bool are_alike(Tag const* tags, Index count) {
    return count < 2 || std::equal(tags + 1, tags + count, tags);
  }
  static constexpr auto all = [] {
    std::array<std::uint16_t, largest> elements{};
    for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = static_cast<std::uint16_t>(e);
    return elements;
  }();

  bool is_alike_ = true;
  Tag tag_ = 0;  // where they are
  std::size_t size_ = 0;
  std::shared_ptr<Mixed const> mixed_;
};

}  // namespace pliant::detail
