#pragma once

#include <pliant/adaptation/element_check.hpp>
#include <pliant/adaptation/estimator/discrepancy.hpp>
#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/force_costs.hpp>
#include <pliant/adaptation/sleep_look.hpp>
#include <pliant/adaptation/spending.hpp>
#include <pliant/solver/make_schedule.hpp>

namespace pliant {

namespace detail {

/// Keeps all values of each element.
template <class T, int Rows>
struct StoreRows {
  static constexpr int counters = 0;
  template <int>
  static constexpr bool bounded = false;
  T* values;  // (rows, elements)
  Index elements;
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own, Again const&,
                                     Tally const&) const {
    for (int k = 0; k < Rows; ++k)
      values[static_cast<std::ptrdiff_t>(elements) * k + e] = rounded_up(own[k]);
  }
};

/// What an element costs in its present group.
template <class Choice>
struct PresentCost {
  Choice choice;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    int const place = choice.place_of(e);
    return place < 0 || choice.sleeps(e)
               ? 0
               : choice.table.cost[place] * static_cast<double>(choice.updates(e));
  }
};

/// The criterion of moves that are decided upon elsewhere.
struct Decided {
  static constexpr Unit unit = Unit::one;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    return typename State::scalar(0);
  }
};

/// A move that a choice makes.
template <class From, class To>
struct GuardedMove : SwitchRule<From, To, Decided> {
  static constexpr bool guards_ellipticity = true;
};

/// Looks that find, in every group of a list, the discrepancy of each but the last, and the moves between them.
template <class... Fs>
struct ChoiceLooks {
  template <std::size_t K>
  using formulation = std::tuple_element_t<K, std::tuple<Fs...>>;
  template <class From, class... Tos>
  static auto moves_of() {
    return std::tuple{GuardedMove<From, Tos>{}...};
  }
  template <std::size_t... K>
  static Discrepancies<formulation<sizeof...(K)>, formulation<K>...> cheaper(
      std::index_sequence<K...>);
  using Found = decltype(cheaper(std::make_index_sequence<sizeof...(Fs) - 1>()));
  using Looks = std::tuple<Look<Fs, Found>...>;
  using Moves = decltype(std::tuple_cat(moves_of<Fs, Fs...>()...));
};

/// What the kernels of a check are made of.
template <class Table, class List>
struct RulesOfChoice;
template <class Table, class... Rules>
struct RulesOfChoice<Table, std::tuple<Rules...>> {
  using type = TableRules<Table, Rules...>;
};

/// The costs of a choice's groups, in that of the last. Throws Error where they do not ascend.
template <class Parts, class... Fs>
std::array<double, sizeof...(Fs)> costs_of(Parts const& parts, ChoiceRule<Fs...> const& rule) {
  if (rule.gives_costs()) return relative_to_last(rule.costs);
  auto const costs = counted_costs(parts, typename ChoiceRule<Fs...>::groups{});
  for (std::size_t k = 1; k < costs.size(); ++k)
    if (!(costs[k] > costs[k - 1]))
      throw Error("within: by counted operations group ", k, " of the list costs ", costs[k],
                  " and the one before it ", costs[k - 1],
                  ", in those of the last; list groups from cheap to costly, or give costs");
  return costs;
}

/// At which levels of local steps the patches of a type are evaluated; empty where one step serves all. It follows from
/// the state: where nothing has made a schedule since it was loaded, one is made for the answer alone.
template <class E, class Parts>
std::vector<StepLevel> levels_of_patches(Parts& parts) {
  constexpr std::size_t type = Parts::layout_type::template type_of<E>;
  bool whole = parts.state.integrator.macro_step > 0;
  parts.for_each_type([&](auto& table, auto& elements) {
    whole = whole && elements.step_levels.size() == static_cast<std::size_t>(table.count());
  });
  if (!whole) return {};
  if (parts.schedule) return parts.schedule->patch_levels[type];
  make_schedule(parts);
  forget_forces(parts);
  auto levels = parts.schedule->patch_levels[type];
  parts.schedule.reset();
  return levels;
}

/// What TableCheck is for rules that compare values with thresholds, for one that chooses.
template <class Parts, class Table, class Elements, class TheRule>
class ChoiceCheck;

template <class Parts, class Table, class Elements, class... Fs>
class ChoiceCheck<Parts, Table, Elements, ChoiceRule<Fs...>>
    : private ElementCheck<Parts, Table, Elements> {
  using Base = ElementCheck<Parts, Table, Elements>;
  using Base::backend, Base::workspace, Base::target;
  using Base::parts_, Base::table_;
  using typename Base::T;
  static constexpr int count = sizeof...(Fs);
  static_assert(((Table::template group_of<Fs> < Table::groups) && ...),
                "a choice names a formulation of which the body has no Group");
  using Of = ChoiceLooks<Fs...>;
  using Looks = typename RulesOfChoice<Table, typename Of::Looks>::type;
  using Moves = typename RulesOfChoice<Table, typename Of::Moves>::type;

 public:
  /// `evaluations`: the budget now; NaN: not known yet, nothing switches.
  ChoiceCheck(Parts& parts, Table& table, Elements& elements, ChoiceRule<Fs...> const& rule,
              double evaluations)
      : Base(parts, table, elements), rule_(rule), evaluations_(evaluations) {}

  void prepare() const {
    auto const levels = levels_of_patches<typename Table::element>(parts_);
    workspace().patch_levels = {};
    if (!levels.empty()) workspace().patch_levels = upload(backend(), levels);
    (void)choice();  // throws where costs do not ascend
    if (reserve()) ++parts_.revision;
  }
  void decide() const {
    auto const c = choice();
    evaluate_criteria(std::as_const(parts_), std::as_const(table_),
                      active(std::as_const(table_).elements), Looks{}, workspace(),
                      StoreRows<T, Looks::rows>{workspace().values.data(), table_.count()},
                      parts_.no_counters);
    auto* const ranking = workspace().rankings.data();
    if (rule_.limits_sums())
      find_spending(backend(), c, rule_.error, evaluations_, workspace().histogram.data(), ranking);
    backend().add_sum(table_.count(),
                      Choose<std::remove_const_t<decltype(c)>, T>{
                          c, rule_.limits_sums() ? ranking : nullptr, workspace().next.data()},
                      parts_.moves.data());
  }
  void act() const { this->move_by(Moves{}); }
  void decide_and_act() const {
    decide();
    act();
  }
  void bound_movers() const { this->bound_those_that_move(); }
  void count_stiffened(StepAllowance const& allowance) const {
    this->count_those_stiffened(allowance);
  }
  /// What its elements cost in their present groups, in evaluations of the last, those that sleep aside.
  double evaluations_now() const {
    auto const c = choice();
    return backend().sum(table_.count(), PresentCost<std::remove_const_t<decltype(c)>>{c});
  }

 private:
  bool reserve() const {
    typename Base::Room room(*this);
    room.hold_switching();
    room.hold_ranking(1);
    room.hold_values(Looks::rows);
    return room.made;
  }
  ChoiceTable<Table::groups, count> places() const {
    ChoiceTable<Table::groups, count> made;
    int const groups[] = {Table::template group_of<Fs>...};
    std::array<double, sizeof...(Fs)> costs{};
    if (rule_.limits_sums()) costs = costs_of(parts_, rule_);
    for (int& place : made.place) place = -1;
    for (int k = 0; k < count; ++k) {
      made.place[groups[k]] = k;
      made.group[k] = static_cast<Tag>(groups[k]);
      made.cost[k] = costs[static_cast<std::size_t>(k)];
      made.whole[k] = static_cast<std::int64_t>(made.cost[k] * made.units + 0.5);
    }
    return made;
  }
  ChoiceOfElement<T, Table::groups, count> choice() const {
    auto const& w = workspace();
    auto const own = target();
    return {places(),
            w.values.data(),
            table_.count(),
            w.number.data(),
            own.tags,
            own.since,
            own.step,
            SleepOfElement::of(parts_, table_),
            w.patch_levels.size() > 0 ? w.patch_levels.data() : nullptr,
            static_cast<T>(rule_.tolerance),
            static_cast<T>(rule_.release),
            rule_.stay,
            !(evaluations_ == evaluations_)};
  }

  ChoiceRule<Fs...> const& rule_;
  double evaluations_;
};

}  // namespace detail

/// What the elements of a choice cost in their present groups, in forces of one element in the last group per step:
/// what WithinOptions::evaluations_per_step limits. Elements that sleep cost nothing; under
/// LocalSteps a step is a macro step, in which an element counts 2^level times, by the level of its patch.
template <DeformableBody TheBody, class... Fs>
double evaluations_per_step(TheBody& body, ChoiceRule<Fs...> const& rule) {
  using E = typename ChoiceRule<Fs...>::element;
  auto& parts = body.parts();
  auto const& table = parts.layout.template table<E>();
  using Table = std::remove_cvref_t<decltype(table)>;
  auto const costs = detail::costs_of(parts, rule);
  auto const groups = body.template groups_of<E>();
  auto const asleep = asleep_elements<E>(body);
  auto const levels = detail::levels_of_patches<E>(parts);
  std::array const places{Table::template group_of<Fs>...};
  auto const& user = table.user_elements();
  double sum = 0;
  std::size_t patch = 0;
  auto const bounds = table.elements.patch_bounds();
  for (std::size_t internal = 0; internal < groups.size(); ++internal) {
    auto const e = static_cast<std::size_t>(user[internal]);
    while (static_cast<std::size_t>(bounds[patch + 1]) <= internal) ++patch;
    auto const place = std::ranges::find(places, int{groups[e]}) - places.begin();
    if (place < ChoiceRule<Fs...>::count && !asleep[e])
      sum += std::ldexp(costs[static_cast<std::size_t>(place)], levels.empty() ? 0 : levels[patch]);
  }
  return sum;
}

}  // namespace pliant
