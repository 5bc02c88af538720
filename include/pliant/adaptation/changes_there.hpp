#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <pliant/backend/copy_values.hpp>
#include <pliant/body/backend_change.hpp>
#include <pliant/body/changed_parts_on.hpp>

namespace pliant::detail {

/// What became of nodes and elements in changes of a body's mesh in its backend's memory, if somebody listens to these: elements are
/// merged, or refined, or both, in this order; or they are raised, or lowered.
template <class Parts>
class ChangesThere {
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using On = TopologyOn<M, B>;
  using Changed = ChangedOn<M, B>;

 public:
  explicit ChangesThere(Parts const& parts) : parts_(parts) {}

  [[nodiscard]] bool any() const { return changed_.has_value(); }
  std::optional<Changed> take() { return std::exchange(changed_, std::nullopt); }

  /// Before a change of the orders of elements; that of the tree may be made.
  void begin(On const& on) {
    pending_.reset();
    if (parts_.backend_listeners.empty()) return;
    pending_.emplace();
    for (std::size_t type = 0; type < On::types; ++type)
      pending_->elements[type] = {parts_.backend, on.element_numbers(type), on.leaves(type).count};
  }
  /// Behind it, before it is put in force. `done`: of the tree; `next`: the body then.
  template <class Done>
  void follow(On const& on, Done const& done, Parts const& next) {
    if (!pending_) return;
    if constexpr (std::derived_from<Done, Coarsened>)
      pending_->nodes = nodes_behind(done);
    else
      pending_->nodes = nodes_after(on, done);
    if constexpr (std::same_as<Done, Raised> || std::same_as<Done, Lowered>)
      return follow_conversion(on);
    else
      on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
        (pending_->elements[I].follow(parts_.backend, on.element_numbers(I),
                                      merged_elements<I>(on, parts_.layout, next.layout)),
         ...);
      });
  }
  /// When it is in force.
  void keep() {
    if (!pending_) return;
    if (changed_) {
      auto& first = changed_->nodes;
      auto& nodes = pending_->nodes;
      nodes.before = first.before;
      nodes.first_moved = first.first_moved;
      nodes.numbers = std::move(first.numbers);
      for (std::size_t type = 0; type < On::types; ++type)
        pending_->elements[type].follow_on(parts_.backend, std::move(changed_->elements[type]));
    }
    changed_ = std::exchange(pending_, std::nullopt);
  }

 private:
  void follow_conversion(On const& on) {
    static constexpr auto other_types = On::types_by(Conversion::degree);
    auto& elements = pending_->elements;
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      auto const follow = [&](std::size_t type) {
        std::size_t const other = other_types[type];
        elements[type].follow_conversion(parts_.backend, on.element_numbers(type),
                                         on.converted_places(other, type), other, elements[other]);
      };
      (follow(I), ...);
    });
    for (auto& own : elements) own.forget_before();
  }
  /// The numbers are a copy, since the tree is gone where what is refined behind it fails.
  ChangedNodesOn<B> nodes_behind(Coarsened const& merged) const {
    auto const moved = static_cast<std::size_t>(merged.before.nodes - merged.staying.nodes);
    auto numbers =
        std::make_shared<typename B::template Array<Index>>(unset<Index>(parts_.backend, moved));
    copy_values<B, Index>(parts_.backend, merged.nodes, numbers->data(), moved);
    return {merged.before.nodes, merged.now.nodes, merged.staying.nodes, std::move(numbers)};
  }
  /// A TreeOn::Refined or Raised.
  template <class Made>
  ChangedNodesOn<B> nodes_after(On const& on, Made const& made) const {
    Index const now = on.tree.sizes().nodes;
    return {.before = now - made.new_nodes,
            .now = now,
            .tree = on.tree.view(),
            .new_nodes = made.new_nodes,
            .made = made.nodes};
  }

  Parts const& parts_;
  std::optional<Changed> pending_, changed_;
};

}  // namespace pliant::detail
