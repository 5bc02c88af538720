#pragma once

#include <algorithm>
#include <numeric>

#include "support/formulations.hpp"

// The contract of backend/backend.hpp, verb by verb.
namespace pliant::test::verbs_suite {

static_assert(!Backend<int>);

template <class T>
struct AddOne {
  T* data;
  PLIANT_HOST_DEVICE void operator()(Index i) const { data[i] += T(i + 1); }
};
struct Triangular {
  PLIANT_HOST_DEVICE double operator()(Index i) const { return i; }
};
/// Its largest value, −1, is at 777.
struct Peak {
  PLIANT_HOST_DEVICE double operator()(Index i) const { return i < 777 ? i - 778 : 776 - i; }
};

/// Σ_a (a + 1) x_a, 10 times for group 1, at every node.
struct WeightedSum {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& x, V const&) const {
    return (*this)(GroupNumber<G>{}, x);
  }
  template <int G, class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    V out = x;
    for (int k = 0; k < 2; ++k) {
      auto sum = x(0, k);
      for (int a = 1; a < 3; ++a) sum = sum + S(a + 1) * x(a, k);
      for (int a = 0; a < 3; ++a) out(a, k) = S(G == 1 ? 10 : 1) * sum;
    }
    return out;
  }
};
struct SumOfNodes {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    return S(G == 1 ? 10 : 1) * (x(0, 0) + x(1, 0) + x(2, 0));
  }
};
template <class T>
struct Record {
  static constexpr int counters = 2;
  T* values;  // (elements, 2)
  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    Vector<S, 1> v;
    v[0] = S(G == 1 ? 10 : 1) * (x(0, 0) + x(1, 0) + x(2, 0));
    return v;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value,
                                 Again const& again, Tally const& tally) const {
    auto const [x] = again();
    values[2 * e] += value[0];
    values[2 * e + 1] += x(2, 1);
    tally(G, 1.0);
  }
};

/// A fan of triangles over a line of nodes with whole numbers at them: sums are exact.
template <class B>
struct Fan {
  using T = typename B::scalar;
  static constexpr Index elements_count = 5000, nodes = elements_count + 2;
  std::vector<std::array<Index, 3>> connectivity;
  std::vector<Tag> tags;
  std::vector<T> x;
  typename B::template Elements<3> elements;
  typename B::template Array<T> on_backend;  // x

  explicit Fan(B const& backend) : x(static_cast<std::size_t>(node_stride * nodes)) {
    for (Index e = 0; e < elements_count; ++e) {
      connectivity.push_back({e, e + 1, e + 2});
      tags.push_back(e % 7 == 0 ? no_group : static_cast<Tag>(e % 3 == 0));
    }
    for (Index i = 0; i < nodes; ++i) {
      x[static_cast<std::size_t>(4 * i)] = static_cast<T>(i % 11);
      x[static_cast<std::size_t>(4 * i + 1)] = static_cast<T>(i % 5);
    }
    elements = {backend, connectivity, 2, tags, nodes};
    on_backend = upload(backend, x);
  }
  NodeField<T const, 2> field() const { return {on_backend.data()}; }
  /// How many rows a field to accumulate into has.
  std::size_t rows() const { return static_cast<std::size_t>(nodes + elements.scratch_nodes()); }
  T value(Index node, int k) const { return x[static_cast<std::size_t>(4 * node + k)]; }
  T factor(Index e) const {
    Tag const tag = tags[static_cast<std::size_t>(e)];
    return tag == no_group ? T(0) : tag == 1 ? T(10) : T(1);
  }
};

TEST_CASE("arrays start at zero and keep what is put into them", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    static_assert(Backend<B>);
    static_assert(BackendArray<typename B::template Array<Index>, Index>);
    auto array = zeros<float>(backend, 1000);
    CHECK(download<float>(array) == std::vector<float>(1000, 0.0f));
    std::vector<float> numbers(1000);
    std::iota(numbers.begin(), numbers.end(), 1.0f);

    array.upload(numbers);
    auto const copy = upload(backend, numbers);
    auto const moved = std::move(array);

    CHECK(download<float>(moved) == numbers);
    CHECK(download<float>(copy) == numbers);
    CHECK(moved.size() == 1000);
    typename B::template Array<float> empty;
    CHECK(empty.size() == 0);
    empty = upload(backend, numbers);
    CHECK(download<float>(empty) == numbers);
    CHECK(zeros<double>(backend, 0).size() == 0);
  });
}

TEST_CASE("values may be put behind others in an array, and changed once they are", "[backend]") {
  on_each_backend<AllPairs>([](auto const& backend) {
    constexpr std::size_t count = 100000, first = 300;
    auto array = upload(backend, std::vector<float>(count + first, 1.0f));
    std::vector<float> given(count, 2.0f);
    array.upload(given, first);
    std::ranges::fill(given, 3.0f);
    array.upload(std::vector<float>{}, count + first);

    std::vector<float> wanted(count + first, 2.0f);
    std::fill_n(wanted.begin(), first, 1.0f);
    CHECK(download<float>(array) == wanted);
    CHECK_THROWS_WITH(array.upload(given, first + 1),
                      says("copy of 100000 values from 301 on, but the array holds 100300"));
    CHECK_THROWS_AS(array.upload(std::vector<float>{}, count + first + 1), Error);
    CHECK(download<float>(array) == wanted);
  });
}

TEST_CASE("copies beyond the end of an array are refused", "[backend]") {
  on_each_backend<AllPairs>([](auto const& backend) {
    auto array = zeros<float>(backend, 1000);
    std::vector<float> numbers(1001, 1.0f);

    CHECK_THROWS_WITH(array.upload(numbers),
                      says("copy of 1001 values from 0 on, but the array holds 1000"));
    CHECK_THROWS_WITH(array.download(numbers),
                      says("copy of 1001 values from 0 on, but the array holds 1000"));

    CHECK(download<float>(array) == std::vector<float>(1000, 0.0f));
  });
}

TEST_CASE("node loops see every node once", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    for (Index n : {0, 1, 31, 4096, 4097, 100000}) {
      INFO(n << " nodes");
      auto seen = zeros<double>(backend, static_cast<std::size_t>(n));

      backend.for_each(n, AddOne<double>{seen.data()});

      auto const values = download<double>(seen);
      for (Index i = 0; i < n; ++i) REQUIRE(values[static_cast<std::size_t>(i)] == i + 1);
      CHECK(backend.sum(n, Triangular{}) == 0.5 * n * (n - 1.0));
      if (n > 777) CHECK(backend.maximum(n, Peak{}) == -1);
    }
    CHECK(backend.maximum(0, Peak{}) == -std::numeric_limits<double>::infinity());
    CHECK(backend.maximum(5, Peak{}) == -774);
  });
}

/// Of the nodes that are no multiple of 3, and of no others.
template <class T>
struct AddOneToSome : AddOne<T> {
  PLIANT_HOST_DEVICE bool selects(Index i) const { return i % 3 != 0; }
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (selects(i)) AddOne<T>::operator()(i);
  }
};

TEST_CASE("node loops that pass over nodes see each of the others once", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    for (Index n : {1, 2, 31, 1023, 1024, 1025, 100000}) {
      INFO(n << " nodes");
      auto seen = zeros<double>(backend, static_cast<std::size_t>(n));

      backend.for_each(n, AddOneToSome<double>{{seen.data()}});

      auto const values = download<double>(seen);
      for (Index i = 0; i < n; ++i)
        REQUIRE(values[static_cast<std::size_t>(i)] == (i % 3 != 0 ? i + 1 : 0));
    }
  });
}

/// Copies the rows of a field.
template <class T, int C>
struct MoveRows {
  NodeField<T const, C> from;
  NodeField<T, C> to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to.set(i, from.at(i)); }
};

template <int C, class B>
void check_rows(B const& backend) {
  using T = typename B::scalar;
  constexpr Index nodes = 1000;
  std::vector<T> numbers(node_stride * nodes);
  std::iota(numbers.begin(), numbers.end(), T(1));
  auto const from = upload(backend, numbers);
  auto to = upload(backend, std::vector<T>(numbers.size(), T(-1)));

  // The first row and the last stay as they are.
  backend.for_each(nodes - 2,
                   MoveRows<T, C>{{from.data() + node_stride}, {to.data() + node_stride}});

  auto const moved = download<T>(to);
  for (Index i = 0; i < nodes; ++i)
    for (int k = 0; k < C; ++k) {
      INFO("row " << i << ", component " << k << " of " << C);
      auto const at = static_cast<std::size_t>(node_stride * i + k);
      REQUIRE(moved[at] == (i == 0 || i == nodes - 1 ? T(-1) : numbers[at]));
    }
}

TEST_CASE("fields read and write their components of a row", "[backend]") {
  on_each_backend<AllPairs>([](auto const& backend) {
    check_rows<1>(backend);
    check_rows<2>(backend);
    check_rows<3>(backend);
    check_rows<4>(backend);
  });
}

/// Every number in the bin of its last byte, but multiples of three in none; or all in one.
struct LastByte {
  bool all_alike;
  PLIANT_HOST_DEVICE Bin operator()(Index i) const {
    return {i % 3 == 0 ? -1 : all_alike ? 7 : i & 255, std::int64_t{i} * (i % 2 == 0 ? 1 : -1)};
  }
};

struct LastNodeIs {
  ElementRows rows;
  Index node;
  PLIANT_HOST_DEVICE bool operator()(Index e) const {
    return rows[e][5] == node && rows[e][0] == e;
  }
};
struct IsWanted {
  Index every;  // 0: none
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return every > 0 && (i * 7) % every == 0; }
};

TEST_CASE("select gives the numbers for which a function holds, ascending", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    for (Index n : {0, 1, 31, 32, 33, 4097, 100000})
      for (Index every : {0, 1, 2, 33, 5000}) {
        INFO("one in " << every << " of " << n);
        std::vector<Index> expected;
        for (Index i = 0; i < n; ++i)
          if (IsWanted{every}(i)) expected.push_back(i);
        CHECK(backend.select(n, IsWanted{every}) == expected);
      }
  });
}

TEST_CASE("tables give the nodes of their elements", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    std::vector<std::array<Index, 6>> connectivity;
    for (Index e = 0; e < 100; ++e) connectivity.push_back({e, e + 1, e + 2, e + 3, e + 4, 2 * e});
    typename B::template Elements<6> const elements(
        backend, connectivity, 1, std::vector<Tag>(100, 0), 200, NodeOrder::as_given);
    auto const rows = elements.rows_of_nodes();
    auto const last_is = [rows](Index node) { return LastNodeIs{rows, node}; };
    CHECK(backend.select(100, last_is(84)) == std::vector<Index>{42});
    CHECK(backend.select(100, last_is(85)).empty());
  });
}

TEST_CASE("a histogram adds weights to bins", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    for (bool all_alike : {false, true})
      for (Index n : {0, 1, 31, 4097, 1000003}) {
        INFO(n << " values");
        std::vector<std::int64_t> expected(histogram_bins, 5);
        for (Index i = 0; i < n; ++i)
          if (Bin const bin = LastByte{all_alike}(i); bin.number >= 0)
            expected[static_cast<std::size_t>(bin.number)] += bin.weight;
        auto bins = upload(backend, std::vector<std::int64_t>(histogram_bins, 5));

        backend.histogram(n, LastByte{all_alike}, bins.data());

        CHECK(download<std::int64_t>(bins) == expected);
      }
  });
}

TEST_CASE("a recording does again what was recorded", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    auto seen = zeros<double>(backend, 3);

    auto const recording =
        backend.record([&] { backend.for_each(3, AddOne<double>{seen.data()}); });
    recording.replay(0);
    recording.replay(2);
    recording.replay(3);
    backend.synchronize();

    CHECK(download<double>(seen) == std::vector<double>{5, 10, 15});
  });
}

TEST_CASE("accumulate adds each element's values to its nodes, by group", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Fan<B> fan(backend);
    auto out = upload(backend, std::vector<T>(node_stride * fan.rows(), T(3)));

    backend.template accumulate<2>(fan.elements, WeightedSum{}, NodeField<T, 2>{out.data()},
                                   fan.field());
    backend.template accumulate<2>(fan.elements, WeightedSum{}, NodeField<T, 2>{out.data()},
                                   fan.field(), fan.field());

    auto const sums = download<T>(out);
    std::vector<T> expected(sums.size(), T(3));
    for (Index e = 0; e < fan.elements_count; ++e)
      for (Index a = 0; a < 3; ++a)
        for (int k = 0; k < 2; ++k)
          expected[static_cast<std::size_t>(4 * (e + a) + k)] +=
              2 * fan.factor(e) *
              (fan.value(e, k) + 2 * fan.value(e + 1, k) + 3 * fan.value(e + 2, k));
    for (Index i = 0; i < fan.nodes; ++i)
      for (int k = 0; k < 2; ++k) {
        INFO("node " << i << ", component " << k);
        REQUIRE(sums[static_cast<std::size_t>(4 * i + k)] ==
                expected[static_cast<std::size_t>(4 * i + k)]);
      }
  });
}

TEST_CASE("loops over elements see each element of a group once", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Fan<B> fan(backend);
    auto const check = [&] {
      auto values = upload(backend, std::vector<T>(2 * fan.connectivity.size(), T(1)));
      auto counters = upload(backend, std::vector<double>{100, 1000});

      double const sum = backend.template sum_elements<2>(fan.elements, SumOfNodes{}, fan.field());
      backend.template visit<2>(fan.elements, Record<T>{values.data()}, counters, fan.field());

      auto const recorded = download<T>(values);
      double expected = 0;
      std::vector<double> counts{100, 1000};
      for (Index e = 0; e < fan.elements_count; ++e) {
        T const own = fan.factor(e) * (fan.value(e, 0) + fan.value(e + 1, 0) + fan.value(e + 2, 0));
        expected += static_cast<double>(own);
        bool const acts = fan.factor(e) != T(0);
        if (acts) ++counts[fan.factor(e) == T(10)];
        REQUIRE(recorded[static_cast<std::size_t>(2 * e)] == T(1) + own);
        REQUIRE(recorded[static_cast<std::size_t>(2 * e + 1)] ==
                T(1) + (acts ? fan.value(e + 2, 1) : T(0)));
      }
      CHECK(sum == expected);
      CHECK(download<double>(counters) == counts);
    };
    CHECK(fan.elements.count() == fan.elements_count);
    check();

    for (std::size_t e = 0; e < fan.tags.size(); ++e)
      fan.tags[e] = e % 5 == 0 ? no_group : static_cast<Tag>(e % 2);
    fan.elements.tags().upload(fan.tags);
    fan.elements.regroup();
    check();
  });
}

/// What verbs over elements give, with forces in whole numbers.
template <class T>
struct Swept {
  std::vector<T> sums, values;
  std::vector<double> counters;
  double total;
  bool operator==(Swept const&) const = default;
};
template <class B, class Table>
auto sweep(B const& backend, Fan<B> const& fan, Table const& table) {
  using T = typename B::scalar;
  auto out = zeros<T>(backend, node_stride * fan.rows());
  auto values = zeros<T>(backend, 2 * fan.connectivity.size());
  auto counters = zeros<double>(backend, 2);
  // What the first loop leaves behind must not be added by the second.
  backend.template accumulate<2>(fan.elements, WeightedSum{}, NodeField<T, 2>{out.data()},
                                 fan.field());
  backend.template accumulate<2>(table, WeightedSum{}, NodeField<T, 2>{out.data()}, fan.field());
  backend.template visit<2>(table, Record<T>{values.data()}, counters, fan.field());
  double const total = backend.template sum_elements<2>(table, SumOfNodes{}, fan.field());
  auto sums = download<T>(out);
  sums.resize(static_cast<std::size_t>(node_stride * fan.nodes));
  return Swept<T>{sums, download<T>(values), download<double>(counters), total};
}

TEST_CASE("loops over a list of patches pass over the elements of the others", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    Fan<B> fan(backend);
    Index const patches = fan.elements.patch_count();
    REQUIRE(patches > 2);
    REQUIRE(patches ==
            (fan.elements_count + fan.elements.patch_size() - 1) / fan.elements.patch_size());
    // Lists: none, one, the last, every second one, all; -1 stands behind the list's end.
    std::vector<std::vector<Index>> const lists = {
        {0, -1},
        {1, 1, -1},
        {1, patches - 1, -1},
        [&] {
          std::vector<Index> all{0};
          for (Index p = 0; p < patches; p += 2) all.push_back(p);
          all[0] = static_cast<Index>(all.size()) - 1;
          return all;
        }(),
        [&] {
          std::vector<Index> all(static_cast<std::size_t>(patches) + 1);
          std::iota(all.begin() + 1, all.end(), 0);
          all[0] = patches;
          return all;
        }()};
    using T = typename B::scalar;
    std::vector<T> values(static_cast<std::size_t>(fan.elements_count));
    for (std::size_t e = 0; e < values.size(); ++e) values[e] = static_cast<T>(e * 7919 % 1009);
    auto const elements_values = upload(backend, values);
    auto const largest_in = [&](std::vector<Index> const& list) {
      double largest = -std::numeric_limits<double>::infinity();
      for (Index e = 0; e < fan.elements_count; ++e)
        if (std::find(list.begin() + 1, list.end(), e / fan.elements.patch_size()) != list.end())
          largest = std::max(largest, static_cast<double>(values[static_cast<std::size_t>(e)]));
      return largest;
    };
    for (auto const& list : lists) {
      INFO(list[0] << " of " << patches << " patches");
      auto tags = std::vector<Tag>(fan.tags.size(), no_group);
      for (Index k = 1; k <= list[0]; ++k) {
        Index const first = list[static_cast<std::size_t>(k)] * fan.elements.patch_size();
        for (Index e = first; e < std::min(fan.elements_count, first + fan.elements.patch_size());
             ++e)
          tags[static_cast<std::size_t>(e)] = fan.tags[static_cast<std::size_t>(e)];
      }
      typename B::template Elements<3> const tagged{backend, fan.connectivity, 2, tags, fan.nodes};
      auto const numbers = upload(backend, list);

      auto const got = sweep(backend, fan, over(fan.elements, numbers));

      CHECK(got == sweep(backend, fan, tagged));
      CHECK((got.total != 0) == (list[0] > 0));
      CHECK(detail::largest_of(backend, over(fan.elements, numbers), elements_values.data()) ==
            largest_in(list));
    }
    CHECK(detail::largest_of(backend, detail::active(fan.elements), elements_values.data()) ==
          largest_in(lists.back()));
    auto const one = upload(backend, std::vector<Index>{1, 1});
    for (Index count : {Index{2}, std::numeric_limits<Index>::max()}) {
      auto const beyond = upload(backend, std::vector<Index>{count, 1});
      CHECK(sweep(backend, fan, over(fan.elements, beyond)) ==
            sweep(backend, fan, over(fan.elements, one)));
    }
    auto const less_than_none = upload(backend, std::vector<Index>{-1, 1});
    CHECK(sweep(backend, fan, over(fan.elements, less_than_none)).total == 0);
    CHECK_THROWS_WITH(over(fan.elements, zeros<Index>(backend, 0)), says("list of patches"));
  });
}

TEST_CASE("elements without tags are of the first group", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    Fan<B> fan(backend);
    using Table = typename B::template Elements<3>;
    Table const without{backend, fan.connectivity, 2, {}, fan.nodes};
    Table const zero{backend, fan.connectivity, 2, std::vector<Tag>(fan.tags.size(), Tag{0}),
                     fan.nodes};

    CHECK(without.count() == fan.elements_count);
    CHECK(download<Tag>(without.tags()) == download<Tag>(zero.tags()));
    CHECK(sweep(backend, fan, without) == sweep(backend, fan, zero));
  });
}

TEST_CASE("a recording of all verbs replays with what arrays then hold", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Fan<B> fan(backend);
    auto out = zeros<T>(backend, node_stride * fan.rows());
    auto values = zeros<T>(backend, 2 * fan.connectivity.size());
    auto counters = zeros<double>(backend, 2), ticks = zeros<double>(backend, 1);
    auto list = upload(backend, std::vector<Index>{1, 0, 0});

    auto const recording = backend.record([&] {
      for (int step = 0; step < 8; ++step) {
        backend.for_each(fan.nodes, Clear<T>{out.data()});
        backend.template accumulate<2>(over(fan.elements, list), WeightedSum{},
                                       NodeField<T, 2>{out.data()}, fan.field());
        backend.for_each(1, AddOne<double>{ticks.data()});
      }
      backend.template visit<2>(over(fan.elements, list), Record<T>{values.data()}, counters,
                                fan.field());
    });
    CHECK(download<double>(ticks)[0] == 0);
    recording.replay(1);
    list.upload(std::vector<Index>{2, 0, 1});
    recording.replay(2);
    auto const forces = download<T>(out);

    CHECK(download<double>(ticks)[0] == 24);
    auto expected = zeros<T>(backend, node_stride * fan.rows());
    backend.template accumulate<2>(over(fan.elements, list), WeightedSum{},
                                   NodeField<T, 2>{expected.data()}, fan.field());
    auto const once = download<T>(expected);
    for (std::size_t i = 0; i < static_cast<std::size_t>(node_stride * fan.nodes); ++i)
      REQUIRE(forces[i] == once[i]);
    double visits = 0;
    for (Index e = 0; e < 2 * fan.elements.patch_size(); ++e)
      if (fan.factor(e) != T(0)) visits += e < fan.elements.patch_size() ? 3 : 2;
    auto const counts = download<double>(counters);
    CHECK(counts[0] + counts[1] == visits);
  });
}

TEST_CASE("a node that does not exist is refused, with its element", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    using Elements = typename B::template Elements<3>;
    using Table = std::vector<std::array<Index, 3>>;
    std::vector<Tag> const tags(2, Tag(0));
    CHECK_THROWS_WITH(Elements(backend, Table{{0, 1, 2}, {1, 2, 3}}, 1, tags, 3),
                      "element 1 has node 3, but nodes are numbered from 0 to 2; mend the mesh");
    CHECK_THROWS_WITH(Elements(backend, Table{{0, -1, 2}, {1, 2, 0}}, 1, tags, 3),
                      says("element 0 has node -1"));
  });
}

TEST_CASE("a table without elements does nothing", "[backend]") {
  on_each_backend<AllPairs>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    typename B::template Elements<3> elements{backend, std::vector<std::array<Index, 3>>{}, 2,
                                              std::vector<Tag>{}, 4};
    auto const x = upload(backend, std::vector<T>(16, T(1)));
    auto out = upload(
        backend, std::vector<T>(static_cast<std::size_t>(16 + 4 * elements.scratch_nodes()), T(3)));
    auto counters = zeros<double>(backend, 2);
    NodeField<T const, 2> const field{x.data()};

    backend.template accumulate<2>(elements, WeightedSum{}, NodeField<T, 2>{out.data()}, field);
    backend.template visit<2>(elements, Record<T>{out.data()}, counters, field);

    for (T value : download<T>(out)) CHECK(value == T(3));
    CHECK(backend.template sum_elements<2>(elements, SumOfNodes{}, field) == 0);
  });
}

}  // namespace pliant::test::verbs_suite
