#pragma once

#include <numeric>

#include "support/formulations.hpp"

namespace pliant::test::marking_suite {

/// Which values act, by sorting them: the most extreme first, equal ones by number.
template <class T>
std::vector<bool> sorted_marks(Marking const& m, std::vector<T> const& values) {
  double const sign = m.below() ? -1 : 1;
  std::vector<std::size_t> order;
  for (std::size_t e = 0; e < values.size(); ++e)
    if (values[e] == values[e]) order.push_back(e);
  auto const ranked = [&](std::size_t k) { return sign * static_cast<double>(values[order[k]]); };
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return sign * values[a] > sign * values[b]; });
  std::size_t acting = order.size();
  auto const only = [&](auto const& holds) {
    std::size_t k = 0;
    while (k < acting && holds(ranked(k))) ++k;
    acting = k;
  };
  auto const at_most = [&](double most) {
    if (static_cast<double>(acting) > most) acting = static_cast<std::size_t>(most);
  };
  switch (m.kind) {
    case MarkingKind::above:
      only([&](double v) { return v > m.amount; });
      break;
    case MarkingKind::below:
      only([&](double v) { return v > -m.amount; });
      break;
    case MarkingKind::fraction_of_largest:
      if (acting > 0)
        only([&, most = std::min(ranked(0), double{std::numeric_limits<T>::max()})](double v) {
          return v > m.amount * most;
        });
      break;
    case MarkingKind::top_share:
      at_most(m.amount * static_cast<double>(acting));
      break;
    case MarkingKind::bulk: {
      double total = 0, sum = 0;
      for (std::size_t k = 0; k < acting; ++k) total += ranked(k);
      std::size_t k = 0;
      while (k < acting && (sum < m.amount * total || (k > 0 && ranked(k) == ranked(k - 1))))
        sum += ranked(k++);
      if (m.amount == 0) k = 0;
      acting = k;
      break;
    }
  }
  if (!m.below()) only([&](double v) { return v > m.floor; });
  if (m.budget < static_cast<std::int64_t>(acting)) at_most(static_cast<double>(m.budget));
  std::vector<bool> marks(values.size());
  for (std::size_t k = 0; k < acting; ++k) marks[order[k]] = true;
  return marks;
}

/// Which values act, by the cut that is found in the backend's memory.
template <class B>
std::vector<bool> marks_of(Marking const& m, B const& backend,
                           std::vector<typename B::scalar> const& values) {
  using T = typename B::scalar;
  T const sign = m.below() ? T(-1) : T(1);
  std::vector<Index> numbers(values.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  auto const array = upload(backend, values);
  auto const number = upload(backend, numbers);
  auto const candidates =
      upload(backend, std::vector<Candidate>(values.size(), Candidate::may_act));
  auto histogram = upload(backend, std::vector<std::int64_t>(histogram_bins, 0));
  auto ranking = zeros<Ranking<T>>(backend, 1);
  detail::find_cut(backend, m,
                   detail::RankedValues<T>{array.data(), candidates.data(), number.data(),
                                           static_cast<Index>(values.size()), sign},
                   histogram.data(), ranking.data());
  auto const cut = download<Ranking<T>>(ranking)[0].cut;
  std::vector<bool> marks;
  for (std::size_t e = 0; e < values.size(); ++e)
    marks.push_back(cut.holds(sign * values[e], static_cast<Index>(e)));
  CHECK(download<std::int64_t>(histogram) == std::vector<std::int64_t>(histogram_bins, 0));
  return marks;
}

/// Values from which some are missing (NaN): spread, with many alike, mostly zero, all alike, some
/// infinite.
template <class T>
std::vector<std::vector<T>> samples() {
  Random random(7);
  std::vector<std::vector<T>> all;
  for (std::size_t size : {1u, 2u, 7u, 100u, 5000u}) {
    for (int kind = 0; kind < 4; ++kind) {
      std::vector<T> values;
      for (std::size_t i = 0; i < size; ++i) {
        double const x = (random() + 1) / 2;
        double const v = kind == 0   ? x
                         : kind == 1 ? std::floor(8 * x) / 8
                         : kind == 2 ? (x > 0.9 ? x : 0)
                                     : 0.375;
        bool const missing = random.below(5) == 0;
        values.push_back(missing ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(v));
      }
      all.push_back(values);
    }
  }
  T const infinite = std::numeric_limits<T>::infinity();
  all.push_back({T(0.5), infinite, T(0.25), std::numeric_limits<T>::quiet_NaN(), T(0.75), T(0.25)});
  all.push_back({infinite, T(0.5), infinite, infinite, T(0.25), infinite, T(0.125)});
  all.push_back({});
  all.push_back(std::vector<T>(5, std::numeric_limits<T>::quiet_NaN()));
  return all;
}

TEST_CASE("the elements that a marking marks are those of a sorted list", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    std::size_t marked = 0, cases = 0;
    for (auto const& values : samples<T>())
      for (auto kind : {MarkingKind::above, MarkingKind::below, MarkingKind::fraction_of_largest,
                        MarkingKind::top_share, MarkingKind::bulk})
        for (double amount : {0.0, 0.125, 0.5, 0.96875, 1.0})
          for (double floor : {-std::numeric_limits<double>::infinity(), 0.25, 2.0})
            for (std::int64_t budget : {std::numeric_limits<std::int64_t>::max(), std::int64_t{1},
                                        std::int64_t{3}, std::int64_t{60}}) {
              Marking const m{kind, amount, floor, budget};
              if (m.below() && std::isfinite(floor)) continue;

              auto const marks = marks_of(m, backend, values);

              auto const expected = sorted_marks(m, values);
              ++cases;
              for (bool mark : marks) marked += mark;
              if (marks != expected) {
                CAPTURE(static_cast<int>(kind), amount, floor, budget, values.size());
                CHECK(std::ranges::count(marks, true) == std::ranges::count(expected, true));
                REQUIRE(marks == expected);
              }
            }
    CHECK(cases == 24 * 5 * (4 * 3 + 1) * 4);
    CHECK(marked > 100000);
  });
}

TEST_CASE("a bulk does not depend on the order of its values", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    // Sums of these in floating point differ in their last bits with the order.
    Random random(9);
    std::vector<T> values;
    for (int i = 0; i < 3000; ++i) values.push_back(static_cast<T>(std::exp(6 * random())));
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (double share : {0.1, 0.5, 0.9}) {
      Marking const m{MarkingKind::bulk, share};
      auto const marks = marks_of(m, backend, values);
      CHECK(marks == sorted_marks(m, values));
      for (int k = 0; k < 5; ++k) {
        for (std::size_t i = order.size(); i > 1; --i)
          std::swap(order[i - 1], order[random.below(i)]);
        std::vector<T> shuffled;
        for (std::size_t i : order) shuffled.push_back(values[i]);

        auto const other = marks_of(m, backend, shuffled);

        for (std::size_t i = 0; i < order.size(); ++i) REQUIRE(other[i] == marks[order[i]]);
      }
    }
  });
}

TEST_CASE("negative values are ranked too", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Random random(8);
    std::vector<T> values;
    for (int i = 0; i < 300; ++i) values.push_back(static_cast<T>(random() - 0.5));
    for (auto kind : {MarkingKind::above, MarkingKind::below, MarkingKind::top_share})
      for (double amount : {-1.0, -0.25, 0.0, 0.25})
        for (std::int64_t budget : {std::numeric_limits<std::int64_t>::max(), std::int64_t{10}}) {
          Marking const m{kind,
                          std::abs(kind == MarkingKind::top_share ? amount : 0) +
                              (kind == MarkingKind::top_share ? 0 : amount),
                          -std::numeric_limits<double>::infinity(), budget};
          CAPTURE(static_cast<int>(kind), amount, budget);
          CHECK(marks_of(m, backend, values) == sorted_marks(m, values));
        }
  });
}

TEST_CASE("a share is rounded down from what it means, not from its product", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    std::vector<T> values(100);
    std::iota(values.begin(), values.end(), T(1));
    for (int percent = 0; percent <= 100; ++percent) {
      auto const marks = marks_of({MarkingKind::top_share, percent / 100.0}, backend, values);
      CHECK(std::ranges::count(marks, true) == percent);
    }
    auto const marks = marks_of({MarkingKind::top_share, 0.2899}, backend, values);
    CHECK(std::ranges::count(marks, true) == 28);
  });
}

TEST_CASE("a bulk is found among values however small", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    for (T size : {T(1), T(1e-12f), T(1e-25f), T(2e-38f)}) {
      std::vector<T> values(1001, size);
      values[500] = 1000 * size;
      auto const count = [&](double share) {
        auto const marks = marks_of({MarkingKind::bulk, share}, backend, values);
        return std::ranges::count(marks, true);
      };
      CHECK(count(0.48) == 1);
      CHECK(count(0.52) == 1001);
    }
  });
}

#if !defined(__CUDACC__)
/// Reference, counting what is asked of it.
struct Counting : Reference<double> {
  int *waits, *histograms;
  template <class F>
  double sum(Index n, F const& f) const {
    ++*waits;
    return Reference<double>::sum(n, f);
  }
  template <class F>
  double maximum(Index n, F const& f) const {
    ++*waits;
    return Reference<double>::maximum(n, f);
  }
  template <class F>
  void histogram(Index n, F const& f, std::int64_t* bins) const {
    ++*histograms;
    Reference<double>::histogram(n, f, bins);
  }
};

TEST_CASE("a cut is found in a pass for each byte, and nothing waits for it", "[adaptation]") {
  for (auto const& values : samples<double>())
    for (auto kind : {MarkingKind::top_share, MarkingKind::bulk, MarkingKind::above,
                      MarkingKind::fraction_of_largest}) {
      int waits = 0, histograms = 0;
      Counting backend;
      backend.waits = &waits;
      backend.histograms = &histograms;

      (void)marks_of(Marking{kind, 0.0625, 0, kind == MarkingKind::above ? 2 : 1000}, backend,
                     values);

      CHECK(waits == 0);
      CHECK(histograms <= 2 + 8 + 8 + 2);
    }
}
#endif

TEST_CASE("shares beyond all and budgets of nothing are refused", "[adaptation]") {
  using F = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const rule = when<F>(EdgeLengthRatio{});
  CHECK_THROWS_AS(rule.top_share(1.01), Error);
  CHECK_THROWS_AS(rule.top_share(-0.01), Error);
  CHECK_THROWS_AS(rule.bulk(NAN), Error);
  CHECK_THROWS_AS(rule.above_fraction_of_largest(2), Error);
  CHECK_THROWS_AS(rule.above(1).budget(0), Error);
  CHECK_NOTHROW(rule.bulk(1).budget(1));
}

TEST_CASE("thresholds that are no numbers, stays and levels below zero are refused",
          "[adaptation]") {
  using F = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const rule = when<F>(EdgeLengthRatio{});
  CHECK_THROWS_WITH(rule.above(NAN), says("above") && says("not a number"));
  CHECK_THROWS_WITH(rule.below(NAN), says("below") && says("not a number"));
  CHECK_THROWS_WITH(rule.above(1).floor(NAN), says("floor") && says("not a number"));
  CHECK_THROWS_WITH(rule.above(1).stay(-1), says("stay of -1") && says("at least 0"));
  CHECK_THROWS_WITH(rule.above(1).refine({.max_level = -1}), says("-1") && says("at least 0"));
  CHECK_THROWS_WITH(rule.above(1).refine({.max_level = most_levels + 1}),
                    says("64") && says("at most 63"));
  CHECK_NOTHROW(rule.above(INFINITY).floor(-INFINITY).stay(0).refine({.max_level = 0}));
  CHECK_NOTHROW(rule.above(1).refine({.max_level = most_levels}));
}

}  // namespace pliant::test::marking_suite
