#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/body/converted_elements_on.hpp>
#include <pliant/body/element_numbers_on.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/body/merged_elements.hpp>
#include <pliant/formulation/mass.hpp>
#include <pliant/math/uncontracted.hpp>

// What becomes of elements in a change of a mesh that is made in a backend's memory.
namespace pliant::detail {

/// Where elements of one type come from in a change, by the user's numbers now: the number before, or of merged ones −1 less the
/// place of their family.
struct FindElementOrigins {
  ElementNumbersView now;
  LeavesView leaves;
  Index const* number_before;  // by the place before
  Index* from;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    from[now.number(i)] = number_before[leaves.from(i)];
  }
};
/// The same of merged ones; and of their families the elements before, with their shares in the volume.
template <Element E>
struct ListMergedFamilies {
  static constexpr Index most = MergedElements<E>::most_gone;
  ElementNumbersView now;
  MergedElements<E> families;
  Index const* number_before;
  Index* from;
  Index* members;  // (families, most)
  double* shares;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const count = families.gone(r);
    if (count == 0) return;
    auto const& leaves = families.leaves;
    from[now.number(leaves.merged_place(r))] = -1 - r;
    double sum = 0;
    for (Index k = 0; k < count; ++k) {
      auto const rest = families.elements.rest(families.rows_gone(r, k));
      double const own = volume<E, MassQuadrature<E>>(rest);
      members[most * r + k] = number_before[leaves.first_child_before(r) + k];
      shares[most * r + k] = own;
      sum += own;
    }
    for (Index k = 0; k < most; ++k)
      if (k < count)
        shares[most * r + k] /= sum;
      else
        members[most * r + k] = -1;
  }
};
/// The same of elements of which some, or what these came for, were of another type: −1.
struct FindConvertedOrigins {
  ElementNumbersView now;
  LeavesView leaves;
  Index const* number_before;  // by the place before
  Index *from, *from_others;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const e = now.number(i);
    from[e] = leaves.comes_from_others(i) ? -1 : number_before[leaves.from(i)];
    from_others[e] = -1;
  }
};
/// Their numbers there.
struct ListConvertedOrigins {
  ElementNumbersView now;
  ConvertedPlaces places;
  Index const* number_before_of_others;  // by the place before
  Index* from_others;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (!places.has(r)) return;
    for (Index k = 0; k < places.families[r].come; ++k)
      from_others[now.number(places.now_at(r) + k)] = number_before_of_others[places.before_at(r)];
  }
};
/// Where elements come from in two changes, one behind the other, of which the second divides nothing that the first merged.
struct ComposeOrigins {
  Index const* first;
  Index* from;  // of the second; of both
  PLIANT_HOST_DEVICE void operator()(Index e) const { from[e] = first[from[e]]; }
};

/// Gives elements the values of those that they come from: see Transfer.
template <class U>
struct CarryElementValues {
  Index const *from, *members;
  double const* shares;
  Index most;  // elements of a family
  std::ptrdiff_t width;
  U const* before;
  U* now;
  Index const* from_others;  // null: none were of another type
  U const* others;           // before, of that type

  PLIANT_HOST_DEVICE void operator()(Index e) const {
    Index const other = from_others != nullptr ? from_others[e] : -1;
    for (std::ptrdiff_t c = 0; c < width; ++c)
      now[width * e + c] = other >= 0     ? others[width * other + c]
                           : from[e] >= 0 ? of(from[e], c)
                                          : merged(-1 - from[e], c);
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE U of(Index element, std::ptrdiff_t c) const {
    return before[width * element + c];
  }
  [[nodiscard]] PLIANT_HOST_DEVICE U merged(Index r, std::ptrdiff_t c) const {
    Index const* const own = members + std::ptrdiff_t{most} * r;
    Index count = 0;
    while (count < most && own[count] >= 0) ++count;
    if constexpr (std::is_integral_v<U> || std::is_enum_v<U>) {
      Index best = 0, best_count = 0;
      for (Index i = 0; i < count; ++i) {
        Index same = 0;
        for (Index j = 0; j < count; ++j) same += of(own[i], c) == of(own[j], c);
        if (same <= best_count) continue;
        best_count = same;
        best = i;
      }
      return of(own[best], c);
    } else {
      U const first = of(own[0], c);
      Uncontracted sum = 0.0;
      bool same = true;  // what all have is not rounded
      for (Index i = 0; i < count; ++i) {
        U const value = of(own[i], c);
        same = same && value == first;
        sum += Uncontracted(shares[std::ptrdiff_t{most} * r + i]) * Uncontracted(value);
      }
      return same ? first : static_cast<U>(sum.value);
    }
  }
};

/// Where the elements of one type come from in a change.
template <Backend B>
class ElementOriginsOn {
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  Index before = 0, now = 0;  // how many there were, and are

  ElementOriginsOn() = default;
  /// Before a change: notes the numbers of the elements by their places.
  ElementOriginsOn(B const& backend, ElementNumbersView const& numbers, Index count)
      : before(count), number_before_(unset<Index>(backend, at(count))) {
    backend.for_each(count, PutNumbers{numbers, nullptr, number_before_.data()});
  }
  /// Behind it. `families`: what it merged.
  template <Element E>
  void follow(B const& backend, ElementNumbersView const& numbers,
              MergedElements<E> const& families) {
    auto const& leaves = families.leaves;
    now = leaves.count;
    most_ = MergedElements<E>::most_gone;
    from_ = unset<Index>(backend, at(now));
    backend.for_each(now, FindElementOrigins{numbers, leaves, number_before_.data(), from_.data()});
    if (families.count > 0) {
      members_ = unset<Index>(backend, at(most_ * families.count));
      shares_ = unset<double>(backend, at(most_ * families.count));
      backend.for_each(families.count,
                       ListMergedFamilies<E>{numbers, families, number_before_.data(), from_.data(),
                                             members_.data(), shares_.data()});
    }
    number_before_ = {};
  }
  /// Behind one in which elements of type `other` became such of this one, `places`.
  void follow_conversion(B const& backend, ElementNumbersView const& numbers,
                         ConvertedPlaces const& places, std::size_t other,
                         ElementOriginsOn const& others) {
    now = places.now.count;
    other_type = other;
    from_ = unset<Index>(backend, at(now));
    from_others_ = unset<Index>(backend, at(now));
    backend.for_each(now, FindConvertedOrigins{numbers, places.now, number_before_.data(),
                                               from_.data(), from_others_.data()});
    backend.for_each(
        places.count,
        ListConvertedOrigins{numbers, places, others.number_before_.data(), from_others_.data()});
  }
  void forget_before() { number_before_ = {}; }
  /// Whether some were of another type, `other_type`: then there are more than before.
  [[nodiscard]] bool come_from_others() const { return from_others_.size() > 0 && now > before; }
  std::size_t other_type = 0;
  /// Becomes that of two changes: `first`, and behind it this one, which merged nothing.
  void follow_on(B const& backend, ElementOriginsOn&& first) {
    backend.for_each(now, ComposeOrigins{first.from_.data(), from_.data()});
    before = first.before;
    members_ = std::move(first.members_);
    shares_ = std::move(first.shares_);
  }

  /// Values of elements: (now, width), of those (before, width), and of those of the other type, or null.
  template <class U>
  [[nodiscard]] Array<U> carry(B const& backend, Array<U> const& values, int width,
                               U const* others = nullptr) const {
    auto carried = unset<U>(backend, at(now) * at(width));
    backend.for_each(
        now, CarryElementValues<U>{from_.data(), members_.data(), shares_.data(), most_, width,
                                   values.data(), carried.data(),
                                   others != nullptr ? from_others_.data() : nullptr, others});
    return carried;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  Array<Index> number_before_;  // by the place, until the change is made
  Array<Index> from_;           // (now): see FindElementOrigins
  Array<Index> from_others_;    // (now): see FindConvertedOrigins
  Array<Index> members_;        // (families, most_): see ListMergedFamilies
  Array<double> shares_;
  Index most_ = 1;
};

}  // namespace pliant::detail
