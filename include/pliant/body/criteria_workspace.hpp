#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// The bits of a number as an unsigned integer that grows with the number; not for NaN.
template <class T>
using OrderedBits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
template <class T>
PLIANT_HOST_DEVICE OrderedBits<T> ordered_bits(T x) {
  constexpr OrderedBits<T> sign = OrderedBits<T>{1} << (8 * sizeof(T) - 1);
  auto const bits = std::bit_cast<OrderedBits<T>>(x == 0 ? T(0) : x);  // −0 equals 0
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
/// The inverse of `ordered_bits`.
template <class T>
PLIANT_HOST_DEVICE T from_ordered_bits(OrderedBits<T> key) {
  constexpr OrderedBits<T> sign = OrderedBits<T>{1} << (8 * sizeof(T) - 1);
  return std::bit_cast<T>((key & sign) != 0 ? key ^ sign : static_cast<OrderedBits<T>>(~key));
}

/// Where the elements end that act, in the order of falling values and, among equal values, of
/// ascending numbers.
template <class T>
struct Cut {
  using Key = OrderedBits<T>;
  Key key;
  Index last;  // the last element that acts with exactly this value; −1: none

  /// Whether an element acts. `value` is negated for rules that look for small values; NaN never acts.
  PLIANT_HOST_DEVICE bool holds(T value, Index number) const {
    if (!(value == value)) return false;
    Key const own = ordered_bits(value);
    return own > key || (own == key && number <= last);
  }
  PLIANT_HOST_DEVICE void tighten(Cut const& other) {
    if (other.key > key || (other.key == key && other.last < last)) *this = other;
  }
  PLIANT_HOST_DEVICE static Cut none() { return {static_cast<Key>(~Key{0}), -1}; }
};

/// What an element is to a rule that ranks.
enum class Candidate : std::uint8_t {
  none,
  looked_at,  ///< of the rule's group, but it may not act: it takes nothing of a share, bulk or budget
  may_act
};

/// The state of a search for a cut, in the backend's memory.
template <class T>
struct Ranking {
  enum State : std::int32_t { searching, all, none };

  Cut<T> cut;
  OrderedBits<T> prefix;   // leading digits found so far
  OrderedBits<T> key;      // of the value at the limit of a count
  std::int64_t remaining;  // weight that is still to be found among values that begin with `prefix`
  double scale;            // from a value to its weight in fixed point; 0: the largest is infinite
  State state;

  Ranking() = default;
  explicit Ranking(int) : Ranking() {}  // arrays begin zeroed
};

/// An element beside those that its parent in the refinement tree was divided into.
struct Siblings {
  Index first = -1;        // of them, by the user's number; −1: not all are elements of its type
  std::uint8_t count = 0;  // of them
  std::uint8_t level = 0;  // how often it was refined

  Siblings() = default;
  PLIANT_HOST_DEVICE Siblings(Index the_first, std::uint8_t the_count, std::uint8_t the_level)
      : first(the_first), count(the_count), level(the_level) {}
};

/// What a check of criteria keeps from pass to pass. It is kept from check to check as well, and goes
/// with the mesh.
template <Backend B>
struct CriteriaWorkspace {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

  Array<T> values;  // (rows, elements)
  Array<T> means;   // (blocks, nodes and scratch rows, 4), of criteria that take means
  Array<T> found;   // (slots, elements): the values of those
  Array<Tag> next;  // (elements): the group after the check
  Array<std::uint32_t> mesh_marks;   // (elements): bit r: rule r refines it, or would merge it
  Array<Index> number;               // (elements): the user's
  Array<Candidate> candidates;       // (elements): of the rule whose cut is searched
  Array<int> levels;                 // (elements): how often each was refined
  Array<Siblings> siblings;          // (elements), by the user's number
  Array<std::uint8_t> patch_levels;  // (patches): of local steps, where a choice counts them
  Array<std::int64_t> histogram;     // (histogram_bins), zero between searches
  Array<Ranking<T>> rankings;        // (rules)
  Array<std::int64_t>
      noted;             // (runs of elements): the last look that had to look at it; see Screen
  Array<Index> flagged;  // on the host: a list of patches that have some, for over()
  /// Copies of what a check changes, to be put back when refinement throws.
  struct Kept {
    Array<Tag> tags;
    Array<std::int64_t> since;
    Array<std::int32_t> switches;
    Array<double> counters;
    Array<double> work;
    Array<T> internal_variables;
  } kept;

  /// Makes an array that is too small anew; whether it did.
  template <class U>
  static bool reserve(B const& backend, Array<U>& array, std::size_t count) {
    if (array.size() >= count) return false;
    array = zeros<U>(backend, count);
    return true;
  }
};

}  // namespace pliant
