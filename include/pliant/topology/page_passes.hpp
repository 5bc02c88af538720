#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/pages.hpp>
#include <pliant/topology/stamps.hpp>

// Loops over the pages of a list in a backend's memory: see PagedList.
namespace pliant::detail {

/// Where the pages of a list stand.
template <class V>
struct PageTables {
  Page<V>** table;      // by the place in the list
  Page<V>** ring;       // pages that are free and, behind them, pages that are left
  Index* places;        // where each of those that are left was; −1: it is free, too
  Index capacity;       // of the ring
  Index* own;           // by the place: a stamp
  Index now;            // the stamp of what is the list's own
  std::uint8_t* noted;  // by the place: whether it changed since the list began to note that

  /// Puts a page from the ring at a place, and what was there into its slot.
  PLIANT_HOST_DEVICE void swap(Index place, Index slot, bool is_own) const {
    auto& here = ring[slot % capacity];
    places[slot % capacity] = is_own ? -1 : place;
    Page<V>* const before = table[place];
    table[place] = here;
    here = before;
  }
};

/// Lists pages that loops are about to change and that are not the list's own yet, each once, and notes them.
struct PageMarker {
  ListOnce list;        // stamps: PageTables::own
  std::uint8_t* noted;  // what is the list's own is noted

  PLIANT_HOST_DEVICE void operator()(std::size_t page) const {
    if (list(static_cast<Index>(page))) noted[page] = 1;
  }
};
/// Notes nothing but what may change unnoticed.
struct BeginNoting {
  Index const* own;
  Index now;
  std::uint8_t* noted;
  PLIANT_HOST_DEVICE void operator()(Index place) const {
    noted[place] = own[place] == now ? 1 : 0;
  }
};
/// Tells how many were listed, and begins anew.
struct TellListed {
  Index *counts, *told;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    told[i] = counts[i];
    counts[i] = 0;
  }
};

/// Puts free pages, from a slot on, in the place of listed ones.
template <class V>
struct ReplaceListedPages {
  PageTables<V> pages;
  Index const* listed;
  Index first;
  PLIANT_HOST_DEVICE void operator()(Index k) const { pages.swap(listed[k], first + k, false); }
};

/// A page as it is copied, so many bytes at a time.
template <class V>
struct PageWords {
  struct alignas(16) Word {
    std::uint32_t bits[4];
  };
  static_assert(sizeof(Page<V>) % sizeof(Word) == 0);
  static constexpr std::size_t each = sizeof(Page<V>) / sizeof(Word);

  static PLIANT_HOST_DEVICE void copy(Page<V> const* from, Page<V>* to, std::size_t word) {
    reinterpret_cast<Word*>(to)[word] = reinterpret_cast<Word const*>(from)[word];
  }
};
/// Gives pages the entries of those in the place of which they came.
template <class V>
struct CopyListedPages {
  PageTables<V> pages;
  Index const* listed;
  Index first;
  PLIANT_HOST_DEVICE void operator()(std::size_t i) const {
    auto const k = static_cast<Index>(i / PageWords<V>::each);
    PageWords<V>::copy(pages.ring[(first + k) % pages.capacity], pages.table[listed[k]],
                       i % PageWords<V>::each);
  }
};

/// Puts free pages behind the others, and notes those from a place on.
template <class V>
struct ExtendTable {
  PageTables<V> pages;
  Index from, before;  // the first that is noted; how many there were
  Index first;         // slot
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const place = from + k;
    pages.noted[place] = 1;
    if (place < before) return;
    pages.table[place] = pages.ring[(first + place - before) % pages.capacity];
    pages.own[place] = pages.now;
  }
};

/// Replaces all pages from a place on by `now` others, as many as there were or fewer, and puts the others into another table.
template <class V>
struct ReplaceFrom {
  PageTables<V> pages;
  Index staying, now;
  Index first, behind;  // slots: of free pages that come, and behind what is left
  Page<V>** before;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const place = staying + k;
    bool const is_own = pages.own[place] == pages.now;
    before[place] = pages.table[place];
    if (k < now) {
      pages.swap(place, first + k, is_own);
      pages.own[place] = pages.now;
      pages.noted[place] = 1;
    } else {
      Index const slot = (behind + k - now) % pages.capacity;
      pages.ring[slot] = pages.table[place];
      pages.places[slot] = is_own ? -1 : place;
    }
  }
};
/// Gives a page what another table has at the same place.
template <class V>
struct CopyPageOf {
  Page<V>* const* from;
  Page<V>* const* to;
  Index place;
  PLIANT_HOST_DEVICE void operator()(Index word) const {
    PageWords<V>::copy(from[place], to[place], static_cast<std::size_t>(word));
  }
};

/// Puts free pages of new memory before the others of a ring, in one with more room.
template <class V>
struct MoveRing {
  PageTables<V> from;
  Index first;  // of these
  V* memory;    // entries of new pages
  Index pages;
  Page<V>** ring;
  Index* places;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (k < pages) {
      ring[k] = reinterpret_cast<Page<V>*>(memory + static_cast<std::size_t>(k) * Page<V>::entries);
      return;
    }
    Index const slot = (first + k - pages) % from.capacity;
    ring[k] = from.ring[slot];
    places[k] = from.places[slot];
  }
};

/// Copies pages one behind the other: listed ones, or all from a place on.
template <class V>
struct GatherPages {
  Page<V>* const* table;
  Index const* listed;  // null: all
  Index first;
  V* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    constexpr auto words = static_cast<Index>(PageWords<V>::each);
    Index const k = i / words;
    PageWords<V>::copy(
        table[listed == nullptr ? first + k : listed[k]],
        reinterpret_cast<Page<V>*>(to + static_cast<std::size_t>(k) * Page<V>::entries),
        static_cast<std::size_t>(i % words));
  }
};

}  // namespace pliant::detail
