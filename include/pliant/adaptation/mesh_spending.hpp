#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/adaptation/force_costs.hpp>
#include <pliant/adaptation/held_offers.hpp>
#include <pliant/adaptation/refinement.hpp>
#include <pliant/body/converted_elements.hpp>

// What a rule that holds a mesh within limits does with it.
namespace pliant::detail {

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

/// What an element costs now; nothing while it sleeps.
template <int Groups>
struct CostOfElement {
  double cost[Groups];  // of one in a group
  Tag const* tags;
  SleepOfElement sleep;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    return tags[e] < Groups && !sleep.sleeps(e) ? cost[tags[e]] : 0;
  }
};

/// How many evaluations a step takes, in forces of one element of the first formulation; elements that sleep take none.
template <class Parts, class E, class... Fs>
double evaluations_of_mesh(Parts const& parts, MeshWithinRule<E, Fs...> const&) {
  auto const costs = costs_beside_first(parts, TypeList<Fs...>{});
  double sum = 0;
  parts.for_each_type([&](auto const& table, auto const& elements) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using Places = HeldPlaces<typename Table::element, MeshWithinRule<E, Fs...>>;
    if constexpr (Places::count > 0) {
      auto const places = places_of_groups<Table>(typename Places::formulations{});
      CostOfElement<Table::groups> own{{}, elements.tags.data(), SleepOfElement::of(parts, table)};
      for (std::size_t group = 0; group < places.size(); ++group)
        own.cost[group] =
            costs[Places::first + static_cast<std::size_t>(std::max(places[group], 0))];
      sum += parts.backend.sum(table.count(), own);
    }
  });
  return sum;
}

/// What each formulation of a list makes of its elements. Those of another degree are on the same cells: of the same law, or
/// of the first formulation.
template <class Parts, class... Fs>
std::array<OfferKind, sizeof...(Fs)> kinds_of(Parts const& parts, TypeList<Fs...> list) {
  auto const costs = costs_beside_first(parts, list);
  constexpr int children = Parts::dim == 2 ? 4 : 8;
  std::size_t k = 0;
  std::array<OfferKind, sizeof...(Fs)> kinds{
      OfferKind{std::pow(0.25, Fs::element::degree), children, costs[k++]}...};
  auto const find = [&]<class F>(TypeList<F>) {
    int first = -1, same = -1, at = 0;
    auto const look_at = [&]<class G>(TypeList<G>) {
      if (G::element::degree != F::element::degree) {
        if (first < 0) first = at;
        if (same_law<F, G> && same < 0) same = at;
      }
      ++at;
    };
    (look_at(TypeList<Fs>{}), ...);
    return same >= 0 ? same : first;
  };
  k = 0;
  auto const link = [&]<class F>(TypeList<F> own) {
    auto& kind = kinds[k++];
    (F::element::degree == 1 ? kind.higher : kind.lower) = find(own);
  };
  (link(TypeList<Fs>{}), ...);
  return kinds;
}

/// What a rule wants of a mesh, of which `evaluations` is the budget; NaN: not known yet. Which elements go to other groups is
/// noted in workspaces, and how many in Parts::moves.
template <class Parts, class Estimate, class... Fs>
MeshMarks decide_on_mesh(Parts& parts, MeshWithinRule<Estimate, Fs...> const& rule,
                         double evaluations) {
  using Rule = MeshWithinRule<Estimate, Fs...>;
  MeshMarks marks{.of_types = std::vector<MarkBits>(TypesOf<typename Parts::mesh_type>::count),
                  .max_level = rule.options.max_level};
  if (std::isnan(evaluations)) return marks;
  auto const kinds = kinds_of(std::as_const(parts), TypeList<Fs...>{});
  // The offers of all types come before decisions about each.
  std::vector<std::unique_ptr<OffersOfType>> all;
  parts.for_each_type([&](auto& table, auto& elements) {
    using Table = std::remove_reference_t<decltype(table)>;
    using Elements = std::remove_reference_t<decltype(elements)>;
    if constexpr (HeldPlaces<typename Table::element, Rule>::count > 0)
      all.push_back(std::make_unique<HeldOffers<Parts, Table, Elements, Rule>>(
          parts, table, elements, rule, kinds));
    else
      all.push_back(nullptr);
  });
  auto const limits = OfferSearch(parts.backend, all, rule.options.release)
                          .limits_for(rule.options.error, evaluations);
  for (std::size_t type = 0; type < all.size(); ++type)
    if (all[type]) all[type]->decide(limits, marks.of_types[type]);
  return marks;
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
