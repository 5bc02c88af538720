#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include <pliant/topology/paged_list.hpp>

#include "support/backends.hpp"
#include "support/catch.hpp"
#include "support/formulations.hpp"
#include "support/random.hpp"

namespace pliant::test::paged_list_suite {

struct WriteEntries {
  Pages<Index> list;
  Index first, value;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    list[static_cast<std::size_t>(first + i)] = value + i;
  }
};
struct RepeatEntries {
  Pages<Index> before, now;
  Index first, period;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    now[static_cast<std::size_t>(first + i)] =
        before[static_cast<std::size_t>(first + (i + 1) % period)];
  }
};

struct MarkPages {
  Index const* pages;
  detail::PageMarker mark;
  PLIANT_HOST_DEVICE void operator()(Index i) const { mark(static_cast<std::size_t>(pages[i])); }
};

/// Makes pages of a list its own.
template <Backend B>
void own_pages(B const& backend, PagedList<B, Index>& list, std::vector<Index> const& pages) {
  auto const listed = upload(backend, pages);
  auto count = zeros<Index>(backend, 1);
  backend.for_each(static_cast<Index>(pages.size()),
                   MarkPages{listed.data(), list.marker(backend, count.data())});
  auto const own = list.own(backend, download<Index>(count)[0]);
  own.replace.run(backend);
  detail::for_each_piece(own.words, [&](std::size_t, Index n) { backend.for_each(n, own.copy); });
}

/// A list in pages, and what it holds.
template <Backend B>
struct Pair {
  B backend;
  PagedList<B, Index> list;
  std::vector<Index> values, kept;
  SharedList<Index> noted;  // when it began to note changes
  Index next = 0;

  explicit Pair(B const& on) : backend(on) {}

  [[nodiscard]] std::size_t page_count() const {
    return (values.size() + Page<Index>::entries - 1) / Page<Index>::entries;
  }
  void write(std::size_t first, std::size_t count) {
    backend.for_each(static_cast<Index>(count),
                     WriteEntries{list.pages(), static_cast<Index>(first), next += 10000});
    std::iota(values.begin() + static_cast<std::ptrdiff_t>(first),
              values.begin() + static_cast<std::ptrdiff_t>(first + count), next);
  }
  void extend(std::size_t count) {
    list.extend(backend, count).run(backend);
    values.resize(values.size() + count);
    write(values.size() - count, count);
  }
  void write_page(std::size_t page) {
    auto const first = page * Page<Index>::entries;
    write(first, std::min(values.size() - first, Page<Index>::entries));
  }
  void change(std::size_t page) {
    own_pages(backend, list, {static_cast<Index>(page), static_cast<Index>(page)});
    write_page(page);
  }
  /// So many pages in eight, of which some are written.
  void change_some(Random& random, std::size_t in_eight) {
    std::vector<Index> touched;
    for (std::size_t page = 0; page < page_count(); ++page)
      if (random.below(8) < in_eight) touched.push_back(static_cast<Index>(page));
    own_pages(backend, list, touched);
    for (Index const page : touched)
      if (random.below(4) == 0) write_page(static_cast<std::size_t>(page));
  }
  void replace_from(std::size_t first, std::size_t count) {
    auto const period = values.size() - first;
    auto const replaced = list.replace_from(backend, first, count);
    detail::in_turn(backend, replaced.replace, replaced.copy, replaced.extend);
    backend.for_each(static_cast<Index>(count),
                     RepeatEntries{replaced.before, list.pages(), static_cast<Index>(first),
                                   static_cast<Index>(period)});
    auto const old = values;
    values.resize(first + count);
    for (std::size_t i = 0; i < count; ++i) values[first + i] = old[first + (i + 1) % period];
  }
  void keep() {
    list.keep();
    kept = values;
  }
  void take_back() {
    list.take_back(backend);
    values = kept;
  }
  void begin_noting() {
    list.begin_noting(backend);
    noted = SharedList<Index>(values);
  }
  void check() {
    REQUIRE(list.size() == values.size());
    REQUIRE(list.download(backend) == values);
    REQUIRE(list.download(backend, noted) == SharedList<Index>(values));
  }
};

TEST_CASE("lists in pages hold what they were given, and take back what was not kept",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Pair<B> on(backend);
    Random random(9);
    constexpr std::size_t most = 4000;
    for (int round = 0; round < 400; ++round) {
      switch (random.below(7)) {
        case 0:
          if (on.values.size() < most) on.extend(random.below(900));
          break;
        case 1:
        case 2:
          if (!on.values.empty()) on.change(random.below(on.page_count()));
          break;
        case 3:
          if (!on.values.empty()) {
            auto first = random.below(on.values.size());
            if (random.below(3) == 0) first -= first % Page<Index>::entries;
            on.replace_from(first, random.below(on.values.size() - first + 300));
          }
          break;
        case 4:
          on.keep();
          break;
        case 5:
          if (random.below(3) == 0) on.begin_noting();
          break;
        default:
          if (random.below(2) == 0) on.take_back();
      }
      on.check();
    }
    CHECK(on.list.bytes() < 5 * most * sizeof(Index));
  });
}

TEST_CASE("lists in pages take back changes of most pages at once, and others behind them",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Pair<B> on(backend);
    Random random(4);
    constexpr std::size_t pages = 60, entries = pages * Page<Index>::entries;
    on.extend(entries - 100);
    on.keep();
    on.begin_noting();
    for (int round = 0; round < 60; ++round) {
      on.change_some(random, round % 5 == 0 ? 3 : 7);
      if (random.below(2) == 0) on.change_some(random, 7);
      if (random.below(2) == 0) on.change(random.below(on.page_count()));
      if (random.below(3) == 0) {
        auto const first = on.values.size() - 1 - random.below(4000);
        on.replace_from(first, random.below(4000));
      }
      auto const size = on.values.size();
      if (size + 1000 < entries) on.extend(entries - size - random.below(1000));
      on.check();
      random.below(2) == 0 ? on.keep() : on.take_back();
      if (random.below(3) == 0) on.begin_noting();
      on.check();
    }
    CHECK(2 * on.list.bytes() < 7 * entries * sizeof(Index));
  });
}

TEST_CASE("pages that went before a list began to note changes are noted when they come again",
          "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Pair<B> on(backend);
    on.extend(3000);
    on.keep();
    on.begin_noting();
    on.replace_from(300, 1000);
    on.begin_noting();
    on.take_back();
    on.check();
  });
}

TEST_CASE("pages that came and went before a list takes that back wait for others", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    Pair<B> on(backend);
    on.extend(1000);
    on.keep();
    on.begin_noting();
    std::size_t bytes = 0;
    for (int round = 0; round < 8; ++round) {
      on.extend(3000);
      on.replace_from(300, 3500);
      on.replace_from(300, 100);
      on.take_back();
      on.check();
      if (round == 0) bytes = on.list.bytes();
    }
    CHECK(on.list.bytes() == bytes);
  });
}

TEST_CASE("a list of many entries in pages holds them in their order", "[topology]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    std::vector<Index> values(300 * Page<Index>::entries + 70);
    std::iota(values.begin(), values.end(), 5);
    PagedList<B, Index> list(backend, SharedList<Index>(values));
    bool const are_same = list.download(backend) == values;
    CHECK(are_same);
  });
}

}  // namespace pliant::test::paged_list_suite
