#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include <pliant/config.hpp>
#include <pliant/topology/pages.hpp>

// Copies of pages, for loops of a backend.
namespace pliant::detail {

/// A page that takes the place of another one, which it is a copy of at first.
template <class V>
struct CopiedPage {
  Index place;  // in the table
  Page<V> const* before;
  Page<V>* now;
};

/// The pages of two tables from a place on, as a list of copies.
template <class V>
struct PagesOfTables {
  Page<V>* const* before;
  Page<V>* const* now;
  Index first;
  PLIANT_HOST_DEVICE CopiedPage<V> operator[](Index k) const {
    return {first + k, before[first + k], now[first + k]};
  }
};

/// Calls visit(p) for the bytes p that are not zero; passes over several at a time where they are.
template <class Visit>
void for_each_marked(std::span<std::uint8_t const> bytes, Visit const& visit) {
  for (std::size_t first = 0; first < bytes.size(); first += sizeof(std::uint64_t)) {
    std::uint64_t some = 0;
    auto const count = std::min(sizeof(some), bytes.size() - first);
    std::memcpy(&some, bytes.data() + first, count);
    if (some == 0) continue;
    for (std::size_t p = first; p < first + count; ++p)
      if (bytes[p] != 0) visit(p);
  }
}

/// A short list that goes with the loop that reads it, so that none is made in a backend's memory.
template <class U>
struct FewValues {
  static constexpr std::size_t most = 32;
  U values[most];
  PLIANT_HOST_DEVICE U const& operator[](Index i) const { return values[i]; }
};
/// Calls f with `values` as a FewValues, if that has room for them: whether it has.
template <class U, class F>
bool with_few(std::span<U const> values, F const& f) {
  if (values.size() > FewValues<U>::most) return false;
  FewValues<U> few{};
  std::copy(values.begin(), values.end(), few.values);
  f(few);
  return true;
}

/// Puts values at places from `to` on.
template <class U>
struct PutFew {
  FewValues<U> values;
  U* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = values[i]; }
};

/// Copies pages, so many bytes at a time, and puts the copies into a table where there is one.
template <class V, class List = CopiedPage<V> const*>
struct CopyPages {
  struct alignas(16) Word {
    std::uint32_t bits[4];
  };
  static_assert(sizeof(Page<V>) % sizeof(Word) == 0);
  static constexpr Index words = sizeof(Page<V>) / sizeof(Word);
  static constexpr Index most_pages = std::numeric_limits<Index>::max() / words;  // in a loop

  List copied;
  Page<V>** table;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const& own = copied[i / words];
    Index const word = i % words;
    if (word == 0 && table != nullptr) table[own.place] = own.now;
    reinterpret_cast<Word*>(own.now)[word] = reinterpret_cast<Word const*>(own.before)[word];
  }
};

/// Puts listed pages, or none, into a table, and those in the place of which they come into another one; of the first, so
/// many words are copied.
template <class V>
struct ReplacePages {
  CopyPages<V> copy;
  Index places, words;
  Page<V>**table, **before;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (i < words) copy(i);
    if (i >= places) return;
    auto const& own = copy.copied[i];
    table[own.place] = own.now;
    before[own.place] = const_cast<Page<V>*>(own.before);
  }
};

}  // namespace pliant::detail
