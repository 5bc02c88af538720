#pragma once

#include <algorithm>
#include <numeric>

#include "support/list_backends.hpp"

// The verbs that write lists into a backend's memory: scan, select and sort.
namespace pliant::test::list_verbs_suite {

/// Around rounds of threads, the longest list of one block, and parts of threads.
inline std::vector<Index> sizes() {
  return {0, 1, 2, 31, 32, 33, 255, 256, 257, 2048, 2049, 4095, 4096, 4097, 6145, 300000};
}
/// Stands behind what a verb may write.
constexpr Index guard = -77;
inline auto guarded(auto const& backend, Index count) {
  return upload(backend, std::vector<Index>(static_cast<std::size_t>(count) + 1, guard));
}
inline std::uint64_t scrambled(Index i) {
  std::uint64_t x = (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  return x ^ x >> 29;
}

/// From −3 to 5, or the same for all.
struct Small {
  Index same;  // negative: none
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return same < 0 ? i * 7 % 9 - 3 : same; }
};
struct Write {
  Small value;
  Index* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = value(i); }
};
struct ValueOf {
  Index const* values;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return values[i]; }
};
struct IsWanted {
  Index every;  // 0: none
  PLIANT_HOST_DEVICE bool operator()(Index i) const {
    return every > 0 && (i % 8191) * 7 % every == 0;
  }
};
struct Differs {
  std::uint64_t const* keys;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return i == 0 || keys[i] != keys[i - 1]; }
};
/// Of the first *count.
struct ValueBelow {
  Index const *values, *count;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return i < *count ? values[i] : 0; }
};

template <class F>
std::vector<Index> sums_of(Index n, F const& f) {
  std::vector<Index> sums{0};
  for (Index i = 0; i < n; ++i) sums.push_back(sums.back() + f(i));
  return sums;
}
template <class F>
std::vector<Index> selected(Index n, F const& f) {
  std::vector<Index> numbers;
  for (Index i = 0; i < n; ++i)
    if (f(i)) numbers.push_back(i);
  return numbers;
}
inline std::vector<Index> followed_by_guard(std::vector<Index> list) {
  list.push_back(guard);
  return list;
}

/// The first entry that is not as expected; −1: none.
template <class U>
std::ptrdiff_t difference(std::vector<U> const& got, std::vector<U> const& expected) {
  auto const [at, end] = std::ranges::mismatch(got, expected);
  return at == got.end() && end == expected.end() ? -1 : at - got.begin();
}

/// Keys with values that tell where they were.
struct Sorted {
  std::vector<std::uint64_t> keys;
  std::vector<Index> values;
  bool operator==(Sorted const&) const = default;

  template <class Key>
  Sorted(Index n, Key const& key) {
    for (Index i = 0; i < n; ++i) {
      keys.push_back(key(i));
      values.push_back(3 * i);
    }
  }
  /// As std::stable_sort has the first n.
  Sorted after(Index n) const {
    std::vector<std::size_t> order(keys.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.begin() + n,
                     [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
    Sorted sorted = *this;
    for (std::size_t i = 0; i < order.size(); ++i) {
      sorted.keys[i] = keys[order[i]];
      sorted.values[i] = values[order[i]];
    }
    return sorted;
  }
  /// As a backend has them.
  Sorted after(auto const& backend, Index n, int bits) const {
    auto own_keys = upload(backend, keys);
    auto own_values = upload(backend, values);
    backend.sort(n, own_keys.data(), own_values.data(), bits);
    Sorted sorted = *this;
    sorted.keys = download<std::uint64_t>(own_keys);
    sorted.values = download<Index>(own_values);
    return sorted;
  }
};

TEST_CASE("scan sums what a function gives for the numbers before", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : sizes())
      for (Index same : {-1, 0, 1}) {
        INFO(n << " numbers, all " << same);
        auto const expected = followed_by_guard(sums_of(n, Small{same}));
        auto to = guarded(backend, n + 1);

        backend.scan(n, Small{same}, to.data());
        CHECK(difference(download<Index>(to), expected) == -1);

        // In place, of what another loop has written.
        backend.for_each(n, Write{Small{same}, to.data()});
        backend.scan(n, ValueOf{to.data()}, to.data());
        CHECK(difference(download<Index>(to), expected) == -1);
      }
  });
}

TEST_CASE("select writes the numbers for which a function holds, and how many", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : sizes())
      for (Index every : {0, 1, 2, 33, 5000}) {
        INFO("one in " << every << " of " << n);
        auto const expected = selected(n, IsWanted{every});
        auto to = guarded(backend, static_cast<Index>(expected.size()));
        auto count = guarded(backend, 1);

        backend.select(n, IsWanted{every}, to.data(), count.data());

        CHECK(difference(download<Index>(to), followed_by_guard(expected)) == -1);
        CHECK(download<Index>(count) == followed_by_guard({static_cast<Index>(expected.size())}));
      }
  });
}

TEST_CASE("sort puts keys in order, with their values", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : sizes())
      for (int bits : {1, 8, 9, 17, 40, 64}) {
        INFO(n << " keys of " << bits << " bits");
        // The last key, the lowest, is not to be sorted.
        Sorted const unsorted(n + 1,
                              [&](Index i) { return i == n ? 0 : scrambled(i) >> (64 - bits); });

        CHECK(unsorted.after(backend, n, bits) == unsorted.after(n));
      }
  });
}

TEST_CASE("sort leaves equal keys in the order they had", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : sizes()) {
      INFO(n << " keys");
      Sorted const zero(n, [](Index) { return std::uint64_t{0}; });
      Sorted const equal(n, [](Index) { return std::uint64_t{5} << 20; });
      Sorted const few(n, [](Index i) { return scrambled(i) % 7 << 20; });
      Sorted const falling(n, [n](Index i) { return static_cast<std::uint64_t>(n - i) / 3; });

      CHECK(zero.after(backend, n, 0) == zero);
      CHECK(equal.after(backend, n, 23) == equal);
      CHECK(few.after(backend, n, 23) == few.after(n));
      CHECK(falling.after(backend, n, 17) == falling.after(n));
    }
  });
}

TEST_CASE("keys that occur are found by select, and numbered by scan", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : sizes()) {
      INFO(n << " keys");
      Sorted const unsorted(n, [](Index i) { return scrambled(i) % 1000 * 1000; });
      auto keys = upload(backend, unsorted.keys);
      auto places = upload(backend, unsorted.values);
      auto firsts = zeros<Index>(backend, static_cast<std::size_t>(n));
      auto count = guarded(backend, 1);
      auto numbers = guarded(backend, n + 1);

      backend.sort(n, keys.data(), places.data(), 20);
      backend.select(n, Differs{keys.data()}, firsts.data(), count.data());
      backend.scan(n, Differs{keys.data()}, numbers.data());

      auto unique = unsorted.keys;
      std::sort(unique.begin(), unique.end());
      unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
      auto const sorted = download<std::uint64_t>(keys);
      auto const found = download<Index>(firsts), number = download<Index>(numbers);
      REQUIRE(download<Index>(count)[0] == static_cast<Index>(unique.size()));
      std::vector<std::uint64_t> of_firsts, of_numbers;
      for (std::size_t k = 0; k < unique.size(); ++k)
        of_firsts.push_back(sorted.at(static_cast<std::size_t>(found[k])));
      // The number of key i: how many are first of theirs up to i, less one.
      for (std::size_t i = 0; i < sorted.size(); ++i)
        of_numbers.push_back(unique.at(static_cast<std::size_t>(number[i + 1] - 1)));
      CHECK(difference(of_firsts, unique) == -1);
      CHECK(difference(of_numbers, sorted) == -1);
    }
  });
}

TEST_CASE("lists of any length follow each other without a wait", "[backend]") {
  on_list_backends([]<class B>(B const& backend) {
    struct Lists {
      Index n;
      Sorted unsorted;
      typename B::template Array<std::uint64_t> keys;
      typename B::template Array<Index> values, sums, found, count;
    };
    std::vector<Lists> all;
    for (Index n : {10, 5000, 20, 5001, 100000, 3, 100000, 600000, 6000}) {
      Sorted unsorted(n, [n](Index i) { return scrambled(i + n) >> 40; });
      auto const size = static_cast<std::size_t>(n);
      all.push_back({n, unsorted, upload(backend, unsorted.keys), upload(backend, unsorted.values),
                     zeros<Index>(backend, size + 1), zeros<Index>(backend, size),
                     zeros<Index>(backend, 1)});
    }

    for (Lists& l : all) {
      backend.scan(l.n, Small{-1}, l.sums.data());
      backend.sort(l.n, l.keys.data(), l.values.data(), 24);
      backend.select(l.n, IsWanted{3}, l.found.data(), l.count.data());
    }

    for (Lists const& l : all) {
      INFO(l.n << " entries");
      auto const expected = l.unsorted.after(l.n);
      CHECK(difference(download<std::uint64_t>(l.keys), expected.keys) == -1);
      CHECK(difference(download<Index>(l.values), expected.values) == -1);
      CHECK(difference(download<Index>(l.sums), sums_of(l.n, Small{-1})) == -1);
      auto found = download<Index>(l.found);
      found.resize(static_cast<std::size_t>(download<Index>(l.count)[0]));
      CHECK(difference(found, selected(l.n, IsWanted{3})) == -1);
    }
  });
}

TEST_CASE("recorded lists are made of what arrays then hold", "[backend]") {
  on_list_backends([](auto const& backend) {
    for (Index n : {100, 20000}) {
      INFO(n << " entries");
      Sorted const first(n, [](Index i) { return scrambled(i) % 5000; });
      Sorted const second(n, [](Index i) { return scrambled(i + 7) % 300; });
      auto keys = upload(backend, first.keys);
      auto values = upload(backend, first.values);
      auto found = guarded(backend, n), count = guarded(backend, 1), sums = guarded(backend, n + 1);
      auto const record = [&] {
        backend.sort(n, keys.data(), values.data(), 13);
        backend.select(n, Differs{keys.data()}, found.data(), count.data());
        backend.scan(n, ValueBelow{found.data(), count.data()}, sums.data());
      };

      auto const recording = backend.record(record);
      // What needs more memory comes between.
      Sorted const large(10 * n, [](Index i) { return scrambled(i); });
      CHECK(large.after(backend, 10 * n, 64) == large.after(10 * n));
      keys.upload(second.keys);
      recording.replay(1);

      auto const expected = second.after(n);
      CHECK(difference(download<std::uint64_t>(keys), expected.keys) == -1);
      CHECK(difference(download<Index>(values), expected.values) == -1);
      auto const firsts = selected(n, Differs{expected.keys.data()});
      CHECK(download<Index>(count)[0] == static_cast<Index>(firsts.size()));
      auto const first_of = [&](Index i) {
        return i < static_cast<Index>(firsts.size()) ? firsts[static_cast<std::size_t>(i)] : 0;
      };
      CHECK(difference(download<Index>(sums), followed_by_guard(sums_of(n, first_of))) == -1);
    }
  });
}

}  // namespace pliant::test::list_verbs_suite
