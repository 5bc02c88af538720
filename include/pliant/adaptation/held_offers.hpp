#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/held_check.hpp>
#include <pliant/adaptation/offer_limits.hpp>
#include <pliant/adaptation/sleep_of_element.hpp>
#include <pliant/backend/copy_values.hpp>

namespace pliant::detail {

/// The places of formulations of one element in the list of a rule.
template <class E, class Rule>
struct HeldPlaces;
template <class E, class Estimate, class... Fs>
struct HeldPlaces<E, MeshWithinRule<Estimate, Fs...>> {
  using formulations = typename MeshWithinRule<Estimate, Fs...>::template on<E>;
  static constexpr int kinds = sizeof...(Fs);
  static constexpr std::size_t count{formulations::size};
  static constexpr std::size_t first = [] {
    std::size_t k = 0;
    (void)((std::same_as<typename Fs::element, E> ? false : (++k, true)) && ...);
    return k;
  }();
};

/// Where the groups of a table stand among those to which a rule moves elements.
template <int Groups, int Count>
struct HeldGroups {
  int place[Groups];  // −1: not among them
  Tag group[Count];
};

/// Takes what is estimated of elements, by their internal numbers.
template <class T, int Groups, int Count>
struct TakeOffered {
  HeldGroups<Groups, Count> groups;
  T const* errors;     // (elements)
  T const* of_groups;  // (Count − 1, elements)
  Index elements;
  Tag const* tags;
  SleepOfElement sleep;
  Index const* number;
  OfferedElement* offered;  // by the user's number
  double* wrong;            // (elements, Count), by the user's number

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    constexpr T most = std::numeric_limits<T>::max();
    Index const e = number[i];
    int const place = tags[i] < Groups ? groups.place[tags[i]] : -1;
    bool const sleeps = sleep.sleeps(i);
    bool may_move = Count > 1 && place >= 0 && !sleeps;
    if constexpr (Count > 1)
      for (int k = 0; k < Count; ++k) {
        T const own =
            k + 1 == Count ? T(0) : of_groups[static_cast<std::ptrdiff_t>(elements) * k + i];
        may_move = may_move && abs(own) <= most;
        wrong[static_cast<std::ptrdiff_t>(Count) * e + k] = static_cast<double>(own);
      }
    T const error = errors[i];
    offered[e] = {abs(error) <= most ? static_cast<double>(error) : 0,
                  static_cast<std::uint8_t>(max(place, 0)), sleeps, may_move};
  }
};

/// Notes the groups that elements go to by limits; 1 for each that moves.
template <class Offers, int Groups, int Count>
struct NoteNext {
  Offers offers;
  OfferLimits limits;
  HeldGroups<Groups, Count> groups;
  Tag const* tags;
  Index const* number;
  Tag* next;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    Index const e = number[i];
    Tag const to = offers.elements[e].may_move ? groups.group[offers.group(e, limits)] : tags[i];
    next[i] = to;
    return to != tags[i];
  }
};

/// Marks elements, by their internal numbers, by what becomes of them.
template <class Offers>
struct MarkHeld {
  Offers offers;
  OfferLimits limits;
  Index const* number;
  std::uint32_t* marks;

  static constexpr std::uint32_t merged = 1;
  static constexpr std::uint32_t bit(MeshAction action) {
    return action == MeshAction::none ? 0 : std::uint32_t{1} << static_cast<int>(action);
  }
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const e = number[i], first = offers.siblings[e].first;
    auto const action = offers.action(e, offers.group(e, limits), limits);
    marks[i] = bit(action) | (first >= 0 && offers.merges(first, limits) ? merged : 0);
  }
};

/// What a rule offers of the elements of one type. Of elements that have a formulation of another degree beside them, all stay
/// open in a search: two limits may make the same of one, and limits between them another thing.
template <class Parts, class Table, class Elements, class Rule>
class HeldOffers final : public OffersOfType {
  using B = typename Parts::backend_type;
  using T = typename Parts::T;
  using E = typename Table::element;
  using Places = HeldPlaces<E, Rule>;
  static constexpr int count = Places::count, groups = Table::groups;
  static constexpr bool has_degrees = Places::kinds > count;
  using Offers = MeshOffers<count, Places::kinds>;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  /// `kinds`: of all formulations of the rule.
  HeldOffers(Parts& parts, Table& table, Elements& elements, Rule const& rule,
             std::array<OfferKind, std::size_t{Places::kinds}> const& kinds)
      : parts_(parts), table_(table), elements_(elements), check_(parts, table, elements) {
    auto const in_all = static_cast<std::size_t>(table.count());
    check_.find_numbers_and_siblings();
    auto const errors = values_on_backend<E>(std::as_const(parts), rule.estimator);
    if constexpr (count > 1) check_.find_errors_of_groups();
    offered_ = unset<OfferedElement>(backend(), in_all);
    families_ = unset<OfferedFamily>(backend(), in_all);
    of_groups_ = unset<double>(backend(), count > 1 ? count * in_all : 0);
    auto& w = table.criteria;
    backend().for_each(table.count(),
                       TakeOffered<T, groups, count>{
                           held_groups(), errors.data(), w.values.data(), table.count(),
                           elements.tags.data(), SleepOfElement::of(std::as_const(parts), table),
                           w.number.data(), offered_.data(), of_groups_.data()});
    for (std::size_t k = 0; k < kinds.size(); ++k) offers_.kinds[k] = kinds[k];
    offers_.first = static_cast<int>(Places::first);
    offers_.release = rule.options.release;
    offers_.max_level = rule.options.max_level;
    offers_.siblings = w.siblings.data();
    offers_.elements = offered_.data();
    offers_.families = families_.data();
    offers_.of_groups = of_groups_.data();
    backend().for_each(table.count(), AddUpFamilies<Offers>{offers_, families_.data()});
  }

  double error_now() const override {
    return backend().sum(table_.count(), ErrorNow<Offers>{offers_});
  }
  double largest_worth() const override { return farthest(false); }
  double inverse_of_least_worth() const override { return farthest(true); }

  void open(OfferSum of) override {
    of_ = of;
    is_listed_ = false;
    open_ = table_.count();
  }
  void add_sum(TriedLimits const& limits, double* to) const override {
    backend().add_sum(open_, outcome_at(limits), to);
  }
  void settle(TriedLimits const& one, TriedLimits const& other, double* settled,
              Index* how_many) override {
    auto const at = outcome_at(one);
    next_ = unset<Index>(backend(), static_cast<std::size_t>(open_));
    backend().select(open_, IsOpen<Offers>{offers_, at.listed, one, other}, next_.data(), how_many);
    if constexpr (!has_degrees)
      backend().add_sum(open_, SettledOutcome<Offers>{at, other}, settled);
  }
  void leave_open(Index how_many) override {
    if constexpr (has_degrees) return;
    if (is_listed_) backend().for_each(how_many, LookUp{list_.data(), next_.data()});
    std::swap(list_, next_);
    is_listed_ = true;
    open_ = how_many;
  }

  void decide(OfferLimits const& limits, MarkBits& bits) const override {
    auto& w = table_.criteria;
    if constexpr (count > 1)
      backend().add_sum(
          table_.count(),
          NoteNext<Offers, groups, count>{offers_, limits, held_groups(), elements_.tags.data(),
                                          w.number.data(), w.next.data()},
          parts_.moves.data());
    using Mark = MarkHeld<Offers>;
    CriteriaWorkspace<B>::reserve(backend(), w.mesh_marks,
                                  static_cast<std::size_t>(table_.count()));
    backend().for_each(table_.count(), Mark{offers_, limits, w.number.data(), w.mesh_marks.data()});
    bits[MeshList::refine] = Mark::bit(MeshAction::divide);
    bits[MeshList::coarsen] = Mark::merged;
    if constexpr (has_degrees) {
      bits[MeshList::raise] = Mark::bit(MeshAction::raise);
      bits[MeshList::lower] = Mark::bit(MeshAction::lower);
    }
  }

 private:
  B const& backend() const { return parts_.backend; }
  OutcomeAt<Offers> outcome_at(TriedLimits const& limits) const {
    return {offers_, {is_listed_ ? list_.data() : nullptr}, of_, limits};
  }
  double farthest(bool inverse) const {
    return backend().maximum(table_.count(), FarthestWorth<Offers>{offers_, inverse});
  }
  static HeldGroups<groups, count> held_groups() {
    HeldGroups<groups, count> made{};
    auto const places = places_of_groups<Table>(typename Places::formulations{});
    for (int g = 0; g < groups; ++g) {
      int const place = places[static_cast<std::size_t>(g)];
      made.place[g] = place;
      if (place >= 0) made.group[place] = static_cast<Tag>(g);
    }
    return made;
  }

  Parts& parts_;
  Table& table_;
  Elements& elements_;
  HeldCheck<Parts, Table, Elements, Rule> check_;
  Array<OfferedElement> offered_;
  Array<OfferedFamily> families_;
  Array<double> of_groups_;
  Offers offers_{};
  // Of a search.
  OfferSum of_ = OfferSum::error;
  bool is_listed_ = false;
  Index open_ = 0;            // how many
  Array<Index> list_, next_;  // of those
};

}  // namespace pliant::detail
