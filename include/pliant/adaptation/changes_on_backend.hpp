#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/adaptation/cells_to_change.hpp>
#include <pliant/adaptation/commits_on_backend.hpp>
#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/backend/host_threads.hpp>

// Changes of a body's mesh that are made in its backend's memory.
namespace pliant::detail {

/// What became of a change.
template <class M, Backend B>
struct ChangeOn {
  typename TopologyPlan<M>::Counts counts{};
  std::size_t new_nodes = 0, gone_nodes = 0;
  ToTell<M, B> to_tell{};  // listeners, who do not know yet
};

/// Changes of a body's mesh in its backend's memory: elements are coarsened, merged, lowered, refined, raised and split, in this order. What
/// goes wrong leaves the body as it was, but for what was done before where memory runs out; what was kept of the mesh there is made anew then
/// when it is needed.
template <class Parts>
class ChangesOnBackend : CommitsOnBackend<Parts> {
  using Base = CommitsOnBackend<Parts>;
  using Base::on, Base::backend;
  using typename Base::B, typename Base::M, typename Base::On;
  using Done = ChangeOn<M, B>;
  using Cells = typename B::template Array<Index>;
  using Marked = MarkedThere<B>;
  using Lists = std::vector<typename Marked::List>;

 public:
  ChangesOnBackend(Parts& parts, int max_level)
      : Base(parts), limits_{parts.limits.nodes, parts.limits.elements, max_level} {}

  /// Elements by the user's numbers. Nothing where the host has to do it.
  std::optional<Done> operator()(Marked const& marked) {
    check_nobody_is_told(std::as_const(parts_), "change of the mesh");
    bool const converts = marked.converts() || marked.splits() || marked.merges();
    if (converts && !can_convert(marked)) return std::nullopt;
    // Listeners there cannot be told where tetrahedra come from that pyramids have for children.
    if (On::has_pyramids && !parts_.backend_listeners.empty()) return std::nullopt;
    if (!parts_.topology_on && !parts_.state.topology->tree && Marked::none_in(marked.refine) &&
        !marked.converts() && !marked.splits()) {
      check("coarsen", marked.coarsen);
      check("merge", marked.merge);
      return Done{};  // nothing to merge
    }
    if (!follow_body()) return std::nullopt;
    if (on().is_too_far_ahead()) (void)*parts_.state.topology;
    bool const tells = !parts_.listeners.empty();
    if (!tells)
      if (auto done = make(marked, marked.coarsen)) return done;
    if (converts) return std::nullopt;
    // The host knows what conditions forbid to merge.
    plan_ = plan_change(std::as_const(parts_), marked.lists(backend()), limits_.max_level);
    if (!plan_) return Done{};
    planned_ = mesh_behind(*plan_, *parts_.state.prescribed);
    auto const merged = merged_by(*plan_);
    auto done = make(marked, Marked::of(ListsOfTypes<std::vector<Index>>(merged)));
    if (done && tells) done->to_tell.plan = std::move(plan_);
    return done;
  }

 private:
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }
  /// Throws Error for an element that there is not.
  void check(char const* verb, Lists const& lists) const {
    std::size_t type = 0;
    parts_.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      if (type < lists.size())
        lists[type].visit(parts_.backend, [&](auto numbers) {
          check_numbers<E>(verb, numbers, static_cast<std::size_t>(table.count()));
        });
      ++type;
    });
  }
  /// The same of all, where one of those that were looked up is none, once the backend was waited for.
  void check_looked_up() const {
    if (parts_.topology_on->unknown.template first<1>()[0] == 0) return;
    check("coarsen", marked_->coarsen);
    check("merge", marked_->merge);
    check("lower", marked_->lower);
    check("refine", marked_->refine);
    check("raise", marked_->raise);
    check("split", marked_->split);
    check("split", marked_->split_in_two);
  }
  Cells cells_of(char const* verb, Lists const& lists) {
    std::size_t count = 0;
    for (auto const& list : lists) count += static_cast<std::size_t>(list.count);
    auto cells = unset<Index>(backend(), count);
    Index* to = cells.data();
    for (std::size_t type = 0; type < lists.size(); to += lists[type++].count) {
      auto const& list = lists[type];
      if (list.count == 0) continue;
      Index const elements = on().leaves(type).count;
      if (elements == 0) check(verb, lists);
      Index const* const numbers =
          list.on_host.empty() ? list.there() : on().from_host.put(list.on_host);
      backend().for_each(list.count, LookUpCells{on().element_numbers(type), elements, numbers, to,
                                                 on().unknown.data()});
    }
    return cells;
  }

  /// Brings what is kept of the mesh up to the body, where the body has changed otherwise; whether that can be.
  bool follow_body() {
    bool const is_there = parts_.topology_on != nullptr;
    if (is_there && on().is_of_conditions(std::as_const(parts_))) return true;
    HostThreads const threads(backend(), *parts_.state.topology);
    if (!is_there) parts_.topology_on = std::make_shared<On>(std::as_const(parts_));
    return on().follow_conditions(std::as_const(parts_));
  }

  /// The elements of families that a plan merges, by the type.
  static std::vector<std::vector<Index>> merged_by(TopologyPlan<M> const& plan) {
    std::vector<std::vector<Index>> merged(On::types);
    for (auto const& family : plan.transfer.families())
      if (family.after.size() == 1)
        for (auto const& member : family.before) merged[member.type].push_back(member.element);
    return merged;
  }

  /// Whether the backend makes the change where elements get another degree or shape: a listener gets it from the host, or by itself where
  /// the degree of some changes and nothing else; and no node may have to stay behind a change that was made.
  [[nodiscard]] bool can_convert(Marked const& marked) const {
    if (marked.converts() && !converts_on_backend<Parts>) return false;
    bool const reshapes = marked.splits() || marked.merges();
    if (reshapes && !splits_on_backend<Parts>) return false;
    if (!parts_.listeners.empty()) return false;
    bool const is_one = marked.kinds() == 1;
    if (!parts_.backend_listeners.empty() && (reshapes || !is_one)) return false;
    bool const takes_nodes = !Marked::none_in(marked.lower) || marked.merges();
    auto const names_nodes = [](auto const& condition) { return condition.facets.empty(); };
    return is_one || !takes_nodes ||
           std::ranges::none_of(parts_.state.prescribed->conditions, names_nodes);
  }
  /// Nothing where conditions forbid some of it; then nothing has changed. Merges these in place of those that are marked.
  std::optional<Done> make(Marked const& marked, Lists const& coarsen) {
    return this->guarded([&] { return change(marked, coarsen); });
  }
  std::optional<Done> change(Marked const& marked, Lists const& coarsen) {
    Done done;
    auto& counts = done.counts;
    std::size_t on_host = 0;
    for (auto const* lists : {&coarsen, &marked.merge, &marked.lower, &marked.refine, &marked.raise,
                              &marked.split, &marked.split_in_two})
      on_host += Marked::count_on_host(*lists);
    on().from_host.begin(backend(), on_host);
    on().unknown.set_all(0);
    marked_ = &marked;
    CellsToChange<B> cells{cells_of("coarsen", coarsen),          cells_of("merge", marked.merge),
                           cells_of("lower", marked.lower),       cells_of("refine", marked.refine),
                           cells_of("raise", marked.raise),       cells_of("split", marked.split),
                           cells_of("split", marked.split_in_two)};
    if (marked.raised_rings > 0 && cells.raise.size() > 0) {
      auto const [n, with_rings] =
          on().tree.with_neighbours(cells.raise.data(), size(cells.raise), marked.raised_rings);
      cells.raise = unset<Index>(backend(), static_cast<std::size_t>(n));
      copy_values<B, Index>(backend(), with_rings, cells.raise.data(), cells.raise.size());
    }
    if (!plan_ && cells.need_trial(limits_))
      cells.template leave_what_is_refined<splits_on_backend<Parts>>(
          backend(), on().tree, nodes_when_raised<M>(), nodes_at_rest(), limits_);
    if (cells.coarsen.size() > 0) {
      auto const merged = on().tree.coarsen(cells.coarsen.data(), size(cells.coarsen));
      if (merged.merged > 0) {
        if (!may_be(merged)) return std::nullopt;
        counts.coarsened = static_cast<std::size_t>(merged.merged);
        done.gone_nodes = static_cast<std::size_t>(merged.before.nodes - merged.now.nodes);
        cells.renumber(backend(), merged);
        bool const is_all = plan_ && plan_->counts.refined == 0;
        auto parents = plan_ && !is_all ? this->parents_of(merged) : std::vector<Index>{};
        commit("coarsen", counts.coarsened, merged, is_all,
               [&](auto& parts) { return parts.coarsened(merged); });
        merged_ = std::move(parents);
      }
    }
    if constexpr (splits_on_backend<Parts>)
      if (cells.merge.size() > 0 && !merge(cells, done)) return std::nullopt;
    if constexpr (converts_on_backend<Parts>)
      if (cells.lower.size() > 0 && !lower(cells.lower, done)) return std::nullopt;
    if (cells.refine.size() > 0) {
      auto const refined = on().tree.refine(cells.refine.data(), size(cells.refine), limits_);
      if (refined.leaves > 0) {
        counts.refined = static_cast<std::size_t>(refined.leaves);
        done.new_nodes += static_cast<std::size_t>(refined.new_nodes);
        commit("refine", counts.refined, refined, plan_.has_value(),
               [&](auto& parts) { return parts.refined(refined); });
        merged_.clear();
      }
    }
    if constexpr (converts_on_backend<Parts>)
      if (cells.raise.size() > 0) raise(cells.raise, done);
    if constexpr (splits_on_backend<Parts>)
      if (cells.splits()) split(cells, done);
    check_looked_up();
    this->enter_as_one(counts);
    done.to_tell.there = there_.take();
    return done;
  }
  template <class... Arguments>
  void commit(Arguments const&... arguments) {
    check_looked_up();
    Base::commit(arguments...);
  }
  /// False where a node has to stay; then nothing has changed.
  bool lower(Cells const& cells, Done& done) {
    auto const lowered = on().tree.lower(cells.data(), size(cells));
    if (lowered.lowered == 0) return true;
    if (!may_be(lowered)) return false;
    done.counts.lowered = static_cast<std::size_t>(lowered.lowered);
    done.gone_nodes += static_cast<std::size_t>(lowered.before.nodes - lowered.now.nodes);
    commit("lower", done.counts.lowered, lowered, false,
           [&](auto& parts) { return parts.changed(lowered); });
    return true;
  }
  void raise(Cells const& cells, Done& done) {
    auto const raised = on().tree.raise(cells.data(), size(cells), nodes_when_raised<M>(), limits_);
    if (raised.raised == 0) return;
    done.counts.raised = static_cast<std::size_t>(raised.raised);
    done.new_nodes += static_cast<std::size_t>(raised.new_nodes);
    commit("raise", done.counts.raised, raised, false,
           [&](auto& parts) { return parts.changed(raised); });
  }
  void split(CellsToChange<B> const& cells, Done& done) {
    auto const split = on().tree.split(cells.to_split(), nodes_at_rest(), limits_);
    if (split.leaves == 0) return;
    done.counts.split = static_cast<std::size_t>(split.leaves);
    done.new_nodes += static_cast<std::size_t>(split.new_nodes);
    commit("split", done.counts.split, split, false,
           [&](auto& parts) { return parts.changed(split); });
  }
  /// False where a node has to stay; then nothing has changed.
  bool merge(CellsToChange<B>& cells, Done& done) {
    auto const merged = on().tree.merge(cells.merge.data(), size(cells.merge));
    if (merged.merged == 0) return true;
    if (!may_be(merged)) return false;
    done.counts.merged = static_cast<std::size_t>(merged.merged);
    done.gone_nodes += static_cast<std::size_t>(merged.before.nodes - merged.now.nodes);
    cells.renumber(backend(), merged);
    commit("merge", done.counts.merged, merged, false,
           [&](auto& parts) { return parts.changed(merged); });
    return true;
  }
  [[nodiscard]] NodesAtRest<Parts::dim> nodes_at_rest() {
    return {{on().points.data()}, on().rows.of_node()};
  }
  /// Whether conditions let a coarsening of the tree be; else it is as it was.
  bool may_be(Coarsened const& done) {
    bool const may = on().held.coarsen(backend(), on().tree, done, on().rows.of_node());
    if (!may) on().tree.take_back();
    return may;
  }
  using Base::parts_, Base::plan_, Base::planned_, Base::merged_, Base::there_;
  RefinementLimits limits_;
  Marked const* marked_ = nullptr;  // of the change that is made
};

}  // namespace pliant::detail
