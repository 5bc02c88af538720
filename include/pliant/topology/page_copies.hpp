#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

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

/// Copies pages, so many bytes at a time, and puts the copies into a table where there is one.
template <class V>
struct CopyPages {
  struct alignas(16) Word {
    std::uint32_t bits[4];
  };
  static_assert(sizeof(Page<V>) % sizeof(Word) == 0);
  static constexpr Index words = sizeof(Page<V>) / sizeof(Word);
  static constexpr Index most_pages = std::numeric_limits<Index>::max() / words;  // in a loop

  CopiedPage<V> const* copied;
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
