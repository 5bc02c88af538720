#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include <pliant/adaptation/choice_check.hpp>
#include <pliant/adaptation/mesh_within.hpp>
#include <pliant/adaptation/siblings_on.hpp>

namespace pliant::detail {

/// The looks at discrepancies and the moves between several formulations on one element; of one alone there are none.
template <class Table, class List>
struct LooksOfHeld {
  static constexpr std::size_t count = List::size;
};
template <class Table, class F, class G, class... Fs>
struct LooksOfHeld<Table, TypeList<F, G, Fs...>> {
  static constexpr std::size_t count = 2 + sizeof...(Fs);
  using Of = ChoiceLooks<F, G, Fs...>;
  using Looks = typename RulesOfChoice<Table, typename Of::Looks>::type;
  using Moves = typename RulesOfChoice<Table, typename Of::Moves>::type;
};

/// The places of a table's groups in a list of formulations; −1: not in it.
template <class Table, class... Fs>
std::array<int, std::size_t{Table::groups}> places_of_groups(TypeList<Fs...>) {
  static_assert(((Table::template group_of<Fs> < Table::groups) && ...),
                "within names a formulation of which the body has no Group");
  std::array<int, std::size_t{Table::groups}> places{};
  places.fill(-1);
  int k = 0;
  ((places[std::size_t{Table::template group_of<Fs>}] = k++), ...);
  return places;
}

/// What TableCheck is for rules that compare values with thresholds, for one that holds a mesh within limits: which groups
/// elements go to is decided for all types together (decide_on_mesh).
template <class Parts, class Table, class Elements, class Rule>
class HeldCheck : private ElementCheck<Parts, Table, Elements> {
  using Base = ElementCheck<Parts, Table, Elements>;
  using Base::backend, Base::workspace;
  using Base::parts_, Base::table_;
  using typename Base::T;
  using List = typename Rule::template on<typename Table::element>;
  using Of = LooksOfHeld<Table, List>;

 public:
  static constexpr bool switches = Of::count > 1;

  HeldCheck(Parts& parts, Table& table, Elements& elements) : Base(parts, table, elements) {}

  void prepare() const {
    if constexpr (switches)
      if (reserve()) ++parts_.revision;
  }
  /// The user's number of each element, and its siblings.
  void find_numbers_and_siblings() const {
    auto& w = workspace();
    auto const count = static_cast<std::size_t>(table_.count());
    if (w.number.size() < count) w.number = numbers_on_backend(parts_, table_);
    if (w.siblings.size() < count)
      w.siblings = siblings_on_backend(std::as_const(parts_), std::as_const(table_),
                                       std::as_const(w).number.data());
  }
  /// Puts what each element gets wrong in each of the groups of the list but the last into the workspace's values, J; NaN
  /// where that is not known.
  void find_errors_of_groups() const
    requires switches
  {
    using Looks = typename Of::Looks;
    evaluate_criteria(std::as_const(parts_), std::as_const(table_),
                      active(std::as_const(table_).elements), Looks{}, workspace(),
                      StoreRows<T, Looks::rows>{workspace().values.data(), table_.count()},
                      parts_.no_counters);
  }

  void act() const {
    if constexpr (switches) this->move_by(typename Of::Moves{});
  }
  void bound_movers() const {
    if constexpr (switches) this->bound_those_that_move();
  }
  void count_stiffened(StepAllowance const& allowance) const {
    if constexpr (switches) this->count_those_stiffened(allowance);
  }
  void keep() const {
    if constexpr (switches) this->keep_what_moves_change();
  }
  void put_back() const {
    if constexpr (switches) this->put_back_what_moves_change();
  }

 private:
  bool reserve() const
    requires switches
  {
    typename Base::Room room(*this);
    room.hold_switching();
    room.hold_values(Of::Looks::rows);
    return room.made;
  }
};

}  // namespace pliant::detail
