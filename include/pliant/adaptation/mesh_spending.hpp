#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/force_costs.hpp>
#include <pliant/adaptation/held_check.hpp>
#include <pliant/adaptation/mesh_offers.hpp>
#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/sleep_look.hpp>
#include <pliant/body/converted_elements.hpp>
#include <pliant/body/groups.hpp>

// What a rule that holds a mesh within limits does with it.
namespace pliant::detail {

/// The elements of a type by their parents, where all children of one are such.
template <Element E, class Parts>
std::vector<std::vector<Index>> families_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  std::vector<std::vector<Index>> families;
  if (!topology.tree) return families;
  std::map<Index, std::vector<Index>> by_parent;
  auto const& cells = topology.cells[Parts::layout_type::template type_of<E>];
  for (std::size_t e = 0; e < cells.size(); ++e)
    if (Index const parent = topology.tree->cell(cells[e]).parent; parent >= 0)
      by_parent[parent].push_back(static_cast<Index>(e));
  for (auto& [parent, children] : by_parent)
    if (children.size() == static_cast<std::size_t>(topology.tree->cell(parent).divided().children))
      families.push_back(std::move(children));
  return families;
}

/// What one element of each formulation costs, in those of the first; counted operations, the same on all machines. Throws Error
/// where of several on one element one costs no more than that before it.
template <class Parts, class... Fs>
std::array<double, sizeof...(Fs)> costs_beside_first(Parts const& parts, TypeList<Fs...> list) {
  if constexpr (sizeof...(Fs) == 1) return {1};
  auto costs = counted_costs(parts, list);
  double const first = costs[0];
  for (double& cost : costs) cost /= first;
  constexpr std::array degree{Fs::element::degree...};
  for (std::size_t k = 1; k < costs.size(); ++k)
    if (degree[k] == degree[k - 1] && !(costs[k] > costs[k - 1]))
      throw Error("within: by counted operations formulation ", k, " of the list costs ", costs[k],
                  " and the one before it, on the same element, ", costs[k - 1],
                  ", in those of the first; list them from cheap to costly");
  return costs;
}

/// The places of formulations of one element in the list of a rule.
template <class E, class Rule>
struct HeldPlaces;
template <class E, class Estimate, class... Fs>
struct HeldPlaces<E, MeshWithinRule<Estimate, Fs...>> {
  using formulations = typename MeshWithinRule<Estimate, Fs...>::template on<E>;
  static constexpr std::size_t count{formulations::size};
  static constexpr std::size_t first = [] {
    std::size_t k = 0;
    (void)((std::same_as<typename Fs::element, E> ? false : (++k, true)) && ...);
    return k;
  }();
};

/// How many evaluations a step takes, in forces of one element of the first formulation; elements that sleep take none.
template <class Parts, class E, class... Fs>
double evaluations_of_mesh(Parts const& parts, MeshWithinRule<E, Fs...> const&) {
  auto const costs = costs_beside_first(parts, TypeList<Fs...>{});
  double sum = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using Places = HeldPlaces<typename Table::element, MeshWithinRule<E, Fs...>>;
    if constexpr (Places::count > 0) {
      auto const places = places_of_groups<Table>(typename Places::formulations{});
      auto const tags = user_groups<typename Table::element>(parts);
      auto const asleep = asleep_on<typename Table::element>(parts);
      for (std::size_t e = 0; e < tags.size(); ++e)
        if (!asleep[e])
          sum += costs[Places::first + static_cast<std::size_t>(std::max(places[tags[e]], 0))];
    }
  });
  return sum;
}

/// What is offered of elements of one type, and which groups they go to.
template <class Parts, class Table, class Elements, class Rule>
class HeldOffers {
  using E = typename Table::element;
  using Places = HeldPlaces<E, Rule>;
  using Check = HeldCheck<Parts, Table, Elements, Rule>;
  static constexpr std::size_t count = Places::count;

 public:
  HeldOffers(Parts& parts, Table& table, Elements& elements)
      : check_(parts, table, elements),
        tags_(user_groups<E>(std::as_const(parts))),
        families_(families_of<E>(std::as_const(parts))) {}

  /// `kinds`: of all formulations of the rule.
  void add_to(MeshOffers& offers, Parts const& parts, Rule const& rule,
              std::span<MeshOffers::Kinds const> kinds) {
    auto const own = kinds.subspan(Places::first, count);
    auto const errors = evaluate_on<E>(parts, rule.estimator);
    auto const levels = levels_of<E>(parts);
    auto const asleep = asleep_on<E>(parts);
    std::vector<double> of_groups;
    if constexpr (count > 1) of_groups = check_.errors_of_groups();
    for (std::size_t e = 0; e < errors.size(); ++e) {
      double const error = std::isfinite(errors[e]) ? errors[e] : 0;
      int const divisions = std::max(0, rule.options.max_level - levels[e]);
      auto const in_list = places_[tags_[e]];
      auto const place = static_cast<std::size_t>(std::max(in_list, 0));
      auto const beside = std::span<double const>(of_groups).subspan(
          of_groups.empty() ? 0 : e * count, of_groups.empty() ? 0 : count);
      bool const may_move = count > 1 && in_list >= 0 &&
                            std::ranges::all_of(beside, [](double x) { return std::isfinite(x); });
      std::size_t offer = 0;
      if (asleep[e])
        offer = offers.add_element(error, asleep_, 0);
      else if (may_move)
        offer = offers.add_element(error, own, place, beside, divisions);
      else
        offer = offers.add_element(error, own[place], divisions);
      if (e == 0) first_ = offer;
      may_move_.push_back(may_move && !asleep[e]);
    }
    for (auto const& family : families_) {
      std::vector<std::size_t> members;
      for (Index e : family) members.push_back(first_ + static_cast<std::size_t>(e));
      auto const number = offers.add_family(members);
      if (&family == &families_.front()) first_family_ = number;
    }
  }
  /// Notes which elements go to other groups; returns how many.
  double note_next(MeshOffers const& offers, MeshOffers::Limits const& limits) const {
    double moves = 0;
    if constexpr (count > 1) {
      auto next = tags_;
      for (std::size_t e = 0; e < next.size(); ++e) {
        if (!may_move_[e]) continue;
        next[e] = group_at(offers.group(first_ + e, limits));
        moves += next[e] != tags_[e] ? 1 : 0;
      }
      check_.note_next(next);
    }
    return moves;
  }
  void mark(MeshOffers const& offers, MeshOffers::Limits const& limits,
            MarkedElements& marked) const {
    for (std::size_t e = 0; e < tags_.size(); ++e) {
      auto const action = offers.action(first_ + e, limits);
      for (auto const& [list, wanted] : {std::pair{&marked.refine, MeshOffers::Action::divide},
                                         {&marked.raise, MeshOffers::Action::raise},
                                         {&marked.lower, MeshOffers::Action::lower}})
        if (action == wanted) list->back().push_back(static_cast<Index>(e));
    }
    for (std::size_t k = 0; k < families_.size(); ++k)
      if (offers.merges(first_family_ + k, limits))
        marked.coarsen.back().insert(marked.coarsen.back().end(), families_[k].begin(),
                                     families_[k].end());
  }

 private:
  static Tag group_at(std::size_t place) {
    return [&]<class... Fs>(TypeList<Fs...>) {
      std::array const groups{static_cast<Tag>(Table::template group_of<Fs>)...};
      return groups[place];
    }(typename Places::formulations{});
  }

  inline static MeshOffers::Kinds const asleep_{{1, 1, 0}};
  Check check_;
  std::vector<Tag> tags_;
  std::vector<std::vector<Index>> families_;
  std::array<int, std::size_t{Table::groups}> places_ =
      places_of_groups<Table>(typename Places::formulations{});
  std::vector<bool> may_move_;
  std::size_t first_ = 0, first_family_ = 0;
};

/// What each formulation of a list makes of its elements.
template <class Parts, class... Fs>
std::array<MeshOffers::Kinds, sizeof...(Fs)> kinds_of(Parts const& parts, TypeList<Fs...> list) {
  auto const costs = costs_beside_first(parts, list);
  constexpr int children = Parts::dim == 2 ? 4 : 8;
  std::size_t k = 0;
  return {MeshOffers::Kinds{{std::pow(0.25, Fs::element::degree), children, costs[k++]}}...};
}
/// Elements of another degree are on the same cells: of the same law, or of the first formulation.
template <class... Fs>
void link_degrees(std::array<MeshOffers::Kinds, sizeof...(Fs)>& kinds, TypeList<Fs...>) {
  auto const find = [&]<class F>(TypeList<F>) -> MeshOffers::Kind const* {
    MeshOffers::Kind const *first = nullptr, *same = nullptr;
    std::size_t k = 0;
    auto const look_at = [&]<class G>(TypeList<G>) {
      auto const* own = &kinds[k++].own;
      if (G::element::degree == F::element::degree) return;
      if (first == nullptr) first = own;
      if (same_law<F, G> && same == nullptr) same = own;
    };
    (look_at(TypeList<Fs>{}), ...);
    return same != nullptr ? same : first;
  };
  std::size_t k = 0;
  auto const link = [&]<class F>(TypeList<F> own) {
    auto& [kind, higher, lower] = kinds[k++];
    (F::element::degree == 1 ? higher : lower) = find(own);
  };
  (link(TypeList<Fs>{}), ...);
}

/// What a rule wants of a mesh, of which `evaluations` is the budget; NaN: not known yet. Which elements go to other groups is
/// noted in workspaces, and how many in Parts::moves.
template <class Parts, class Estimate, class... Fs>
MarkedElements decide_on_mesh(Parts& parts, MeshWithinRule<Estimate, Fs...> const& rule,
                              double evaluations) {
  using Rule = MeshWithinRule<Estimate, Fs...>;
  MarkedElements marked;
  std::array const lists{&marked.refine, &marked.coarsen, &marked.raise, &marked.lower};
  if (std::isnan(evaluations)) return marked;
  auto kinds = kinds_of(std::as_const(parts), TypeList<Fs...>{});
  link_degrees(kinds, TypeList<Fs...>{});
  MeshOffers offers(rule.options.release);
  double moves = 0;
  // The offers of all types come before decisions about each.
  std::vector<std::function<void(MeshOffers::Limits const&)>> decisions;
  parts.for_each_type([&](auto& table, auto& elements) {
    using Table = std::remove_reference_t<decltype(table)>;
    using Elements = std::remove_reference_t<decltype(elements)>;
    if constexpr (HeldPlaces<typename Table::element, Rule>::count > 0) {
      auto of_type =
          std::make_shared<HeldOffers<Parts, Table, Elements, Rule>>(parts, table, elements);
      of_type->add_to(offers, std::as_const(parts), rule, kinds);
      decisions.push_back([&, of_type](MeshOffers::Limits const& limits) {
        moves += of_type->note_next(offers, limits);
        of_type->mark(offers, limits, marked);
      });
    } else {
      decisions.push_back([](MeshOffers::Limits const&) {});
    }
  });
  auto const limits = offers.limits_for(rule.options.error, evaluations);
  for (auto const& decide : decisions) {
    for (auto* list : lists) list->emplace_back();
    decide(limits);
  }
  parts.moves.upload(std::array{moves});
  return marked;
}

}  // namespace pliant::detail

namespace pliant {

/// What a step of the elements of a rule that holds a mesh costs, in forces of one element of its first formulation: what
/// MeshWithinOptions::evaluations_per_step limits. Elements that sleep cost nothing.
template <DeformableBody TheBody, class E, class... Fs>
double evaluations_per_step(TheBody const& body, MeshWithinRule<E, Fs...> const& rule) {
  return detail::evaluations_of_mesh(body.parts(), rule);
}

}  // namespace pliant
