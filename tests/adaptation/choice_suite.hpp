#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// Choices among several groups: cheapest and within.
namespace pliant::test::choice_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Coarse = Formulation<Quad4, OnePoint, NeoHookean>;
static_assert(ChoosingRule<ChoiceRule<Linear, Turning, Rubber>>);
static_assert(Rule<ChoiceRule<Linear, Turning, Rubber>>);
static_assert(!SwitchingRule<ChoiceRule<Linear, Turning, Rubber>>);
static_assert(Estimator<Discrepancy<Rubber>, Linear>);
static_assert(Estimator<Discrepancy<Rubber>, Coarse>);

/// What a choice finds of a group, in whatever group an element is.
template <class F>
struct In {
  static constexpr Unit unit = Unit::joule;
  static constexpr bool reads_young = true;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return detail::Discrepancies<Rubber, F>{}(e)[0];
  }
};

/// The k-th of what a choice finds of several groups at once.
template <int K, class... Fs>
struct InOneOf {
  static constexpr Unit unit = Unit::joule;
  static constexpr bool reads_young = true;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return detail::Discrepancies<Rubber, Fs...>{}(e)[K];
  }
};

template <class B>
auto three_laws(B const& backend, Mesh<Quad4> const& mesh) {
  return Body{backend, mesh, soft, Group<Linear>{}, Group<Turning>{}, Group<Rubber>{}};
}
template <class F, class TheBody>
void put_all_into(TheBody& body) {
  std::vector<Index> all(body.mesh().template elements<typename F::element>().size());
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
  body.template assign<F>(all);
}
/// The discrepancies from Rubber that all elements would have in each group, J: (groups, elements).
template <class B, class U>
auto errors_of_groups(B const& backend, Mesh<Quad4> const& mesh, U const& u) {
  auto body = three_laws(backend, mesh);
  body.set_displacements(u);
  std::array<std::vector<double>, 3> errors;
  put_all_into<Linear>(body);
  errors[0] = evaluate<Quad4>(body, Discrepancy<Rubber>{});
  put_all_into<Turning>(body);
  errors[1] = evaluate<Quad4>(body, Discrepancy<Rubber>{});
  put_all_into<Rubber>(body);
  errors[2] = evaluate<Quad4>(body, Discrepancy<Rubber>{});
  return errors;
}
/// Displacements that strain more the larger x is, and turn one half.
inline FieldOf<2> uneven(Mesh<Quad4> const& mesh) {
  auto u = Random(2).field<2>(mesh.nodes.size(), 0.01);
  for (std::size_t i = 0; i < u.size(); ++i) {
    double const x = mesh.nodes[i][0], y = mesh.nodes[i][1], angle = x > 0.5 ? 0.05 : 0;
    double const c = std::cos(angle) - 1, s = std::sin(angle), share = std::pow(x, 4);
    u[i] = {share * u[i][0] + c * (x - 0.5) - s * y, share * u[i][1] + s * (x - 0.5) + c * y};
  }
  return u;
}
template <class Groups>
std::array<long, 3> numbers_in(Groups const& groups) {
  std::array<long, 3> n{};
  for (std::size_t g = 0; g < 3; ++g) n[g] = std::ranges::count(groups, static_cast<Tag>(g));
  return n;
}
inline double most_of(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() * 7 / 10];
}

TEST_CASE("each element goes to the cheapest group that is right within the tolerance",
          "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const u = uneven(mesh);
    auto const errors = errors_of_groups(backend, mesh, u);
    double const tolerance = 1.001 * most_of(errors[1]);
    auto body = three_laws(backend, mesh);
    body.set_displacements(u);

    Adaptation{cheapest<Linear, Turning, Rubber>({.tolerance = tolerance})}.now(body);

    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < groups.size(); ++e) {
      Tag const expected = errors[0][e] <= tolerance ? 0 : errors[1][e] <= tolerance ? 1 : 2;
      CHECK(groups[e] == expected);
    }
    for (double error : evaluate<Quad4>(body, Discrepancy<Rubber>{})) CHECK(error <= tolerance);
    for (long n : numbers_in(groups)) CHECK(n > 0);
    CHECK(errors[2] == std::vector<double>(groups.size(), 0.0));
  });
}

TEST_CASE("the list says what is cheap, whatever the order of the body's groups", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(6);
    Body body{backend, mesh, soft, Group<Rubber>{}, Group<Linear>{}, Group<Turning>{}};
    body.template assign<Turning>({3, 4});
    auto const to_linear = cheapest<Linear, Rubber>({.tolerance = 1e-9});

    Adaptation{to_linear}.now(body);  // at rest

    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < groups.size(); ++e)
      CHECK(int{groups[e]} == (e == 3 || e == 4 ? 2 : 1));  // Turning is not in the list
  });
}

TEST_CASE("elements return below a share of the tolerance, and after their stay", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const u = uneven(mesh);
    auto const errors = errors_of_groups(backend, mesh, u);
    double const tolerance = 1.001 * most_of(errors[1]);
    auto const from_rubber = [&](CheapestOptions const& options) {
      auto body = three_laws(backend, mesh);
      put_all_into<Rubber>(body);
      body.set_displacements(u);
      Adaptation{cheapest<Linear, Turning, Rubber>(options)}.now(body);
      return body.template groups_of<Quad4>();
    };

    int held = 0;
    auto const groups = from_rubber({.tolerance = tolerance, .release = 0.3});
    auto const stayed = from_rubber({.tolerance = tolerance, .release = 0.3, .stay = 1});

    for (std::size_t e = 0; e < groups.size(); ++e) {
      double const limit = 0.3 * tolerance, least = std::min(errors[0][e], errors[1][e]);
      held += limit < least && least <= tolerance;
      CHECK(int{groups[e]} == (errors[0][e] <= limit ? 0 : errors[1][e] <= limit ? 1 : 2));
      CHECK(int{stayed[e]} == 2);
    }
    CHECK(held > 0);
  });
}

/// The groups of a list (cost, error) that cost least for an error, or err least for a cost, where all elements may
/// go anywhere: offers along each element's convex hull, in the order of their worth.
struct Offered {
  double worth;
  std::size_t element;
  int to;
  double error, cost;  // what it takes away, and costs
};
inline std::vector<Offered> all_offers(std::array<std::vector<double>, 3> const& errors,
                                       std::array<double, 3> const& costs) {
  std::vector<Offered> offers;
  for (std::size_t e = 0; e < errors[0].size(); ++e) {
    auto const offer = [&](std::size_t from, std::size_t to) {
      double const error = errors[from][e] - errors[to][e], cost = costs[to] - costs[from];
      return Offered{error / cost, e, static_cast<int>(to), error, cost};
    };
    if (offer(0, 1).worth > offer(0, 2).worth) {
      offers.push_back(offer(0, 1));
      if (errors[1][e] > 0) offers.push_back(offer(1, 2));
    } else if (errors[0][e] > 0) {
      offers.push_back(offer(0, 2));
    }
  }
  std::ranges::sort(offers, [](auto const& a, auto const& b) { return a.worth > b.worth; });
  return offers;
}
inline double sum_of(std::vector<double> const& values) {
  double sum = 0;
  for (double value : values) sum += value;
  return sum;
}
constexpr std::array<double, 3> some_costs{0.2, 0.35, 1};

TEST_CASE("an error is held by the offers of most worth, and by no more", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const u = uneven(mesh);
    auto const errors = errors_of_groups(backend, mesh, u);
    double const all = sum_of(errors[0]);
    for (double share : {2.0, 0.3, 0.01, 1e-4, 1e-9}) {
      auto body = three_laws(backend, mesh);
      body.set_displacements(u);
      auto const rule =
          within<Linear, Turning, Rubber>({.error = share * all, .costs = some_costs});

      Adaptation{rule}.now(body);

      std::vector<Tag> expected(errors[0].size(), Tag{0});
      double left = all;
      for (auto const& offer : all_offers(errors, some_costs)) {
        if (left <= share * all) break;
        left -= offer.error;
        expected[offer.element] = static_cast<Tag>(offer.to);
      }
      INFO(share);
      CHECK(body.template groups_of<Quad4>() == expected);
      CHECK(estimate(body, Discrepancy<Rubber>{}) <= share * all * (1 + 1e-12));
    }
  });
}

TEST_CASE("a budget goes to the offers of most worth, as far as it reaches", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const u = uneven(mesh);
    auto const errors = errors_of_groups(backend, mesh, u);
    auto const n = static_cast<double>(errors[0].size());
    for (double share : {0.1, 0.25, 0.4, 0.9, 1.5}) {
      auto body = three_laws(backend, mesh);
      body.set_displacements(u);
      auto const rule = within<Linear, Turning, Rubber>(
          {.evaluations_per_step = share * n, .costs = {0.4, 0.7, 2}});  // in any unit

      Adaptation{rule}.now(body);

      std::vector<Tag> expected(errors[0].size(), Tag{0});
      double spent = some_costs[0] * n;
      for (auto const& offer : all_offers(errors, some_costs)) {
        if (spent + offer.cost > share * n) break;
        spent += offer.cost;
        expected[offer.element] = static_cast<Tag>(offer.to);
      }
      INFO(share);
      CHECK(body.template groups_of<Quad4>() == expected);
      CHECK(evaluations_per_step(body, rule) == Approx(spent));
    }
  });
}

TEST_CASE("of an error and a budget the stricter holds", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const groups_by = [&](double error, double evaluations) {
      auto body = three_laws(backend, mesh);
      body.set_displacements(uneven(mesh));
      Adaptation{within<Linear, Rubber>({.error = error, .evaluations_per_step = evaluations})}.now(
          body);
      return body.template groups_of<Quad4>();
    };
    constexpr double none = WithinOptions<2>::none;
    double const all = [&] {
      auto body = three_laws(backend, mesh);
      body.set_displacements(uneven(mesh));
      return estimate(body, Discrepancy<Rubber>{});
    }();
    auto const by_error = groups_by(0.1 * all, none), by_budget = groups_by(none, 75);
    REQUIRE(numbers_in(by_error)[2] != numbers_in(by_budget)[2]);
    bool const error_is_stricter = numbers_in(by_error)[2] < numbers_in(by_budget)[2];

    CHECK(groups_by(0.1 * all, 75) == (error_is_stricter ? by_error : by_budget));
    CHECK(groups_by(all, 75) == groups_by(all, none));
    CHECK(groups_by(1e-12 * all, 75) == by_budget);
  });
}

TEST_CASE("equal offers are taken by number, as many as the budget allows", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {16, 16}, .cells = {16, 16}});
    auto body = three_laws(backend, mesh);
    auto h = Tensor<double, 2>::zero();
    h(0, 0) = 0.125;  // exact: all elements are the same to the bit
    body.set_displacements(uniform(mesh.nodes, h));

    Adaptation{within<Linear, Rubber>({.evaluations_per_step = 178, .costs = {0.5, 1}})}.now(body);

    auto const groups = body.template groups_of<Quad4>();
    CHECK(numbers_in(groups)[2] == 100);
    auto const values = evaluate<Quad4>(body, In<Linear>{});
    if (std::ranges::count(values, values[0]) == 256)
      for (std::size_t e = 0; e < 256; ++e) CHECK((groups[e] == 2) == (e < 100));
  });
}

TEST_CASE("a discrepancy is the same from whatever group it is looked at", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(8);
    Body body{backend,         mesh,           soft, Group<Linear>{Hooke<double>{30, 20}},
              Group<Coarse>{}, Group<Rubber>{}};
    body.set_displacements(uneven(mesh));
    auto const sum_within = [&]<class F>(List<F>) {
      put_all_into<F>(body);
      return std::pair{estimate(body, In<Linear>{}), estimate(body, In<Coarse>{})};
    };
    auto const linear = sum_within(List<Linear>{}), coarse = sum_within(List<Coarse>{}),
               rubber = sum_within(List<Rubber>{});

    CHECK(linear.first > 0);
    CHECK(coarse.first == Approx(linear.first));
    CHECK(rubber.first == Approx(linear.first));
    CHECK(linear.second == Approx(coarse.second));
    CHECK(rubber.second == Approx(coarse.second));
  });
}

TEST_CASE("a discrepancy is the same by itself and beside those of other rules", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rough = Formulation<Quad4, OnePoint, Hooke>;
    auto const mesh = distorted_mesh<Quad4>(8);
    Body body{backend, mesh, soft, Group<Linear>{}, Group<Rough>{}, Group<Rubber>{}};
    body.set_displacements(uneven(mesh));
    double const linear = estimate(body, In<Linear>{}), rough = estimate(body, In<Rough>{});

    CHECK(linear > 0);
    CHECK(rough != Approx(linear));
    CHECK(estimate(body, InOneOf<0, Linear, Rough>{}) == Approx(linear));
    CHECK(estimate(body, InOneOf<1, Linear, Rough>{}) == Approx(rough));
  });
}

TEST_CASE("laws, rules of quadrature and both are chosen among", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rough = Formulation<Quad4, OnePoint, Hooke>;
    auto const mesh = distorted_mesh<Quad4>(10);
    Body body{backend, mesh, soft, Group<Rough>{}, Group<Coarse>{}, Group<Rubber>{}};
    body.set_displacements(uneven(mesh));
    double const rough = estimate(body, Discrepancy<Rubber>{});
    put_all_into<Coarse>(body);
    double const coarse = estimate(body, Discrepancy<Rubber>{});
    Body of_one_law{backend, mesh, soft, Group<Coarse>{}, Group<Rubber>{}};
    of_one_law.set_displacements(uneven(mesh));
    CHECK(coarse == Approx(estimate(of_one_law, QuadratureDiscrepancy<Rubber>{})));
    CHECK(coarse < rough);
    auto const rule = within<Rough, Coarse, Rubber>({.error = 0.3 * coarse});

    Adaptation{rule}.now(body);

    CHECK(estimate(body, Discrepancy<Rubber>{}) <= 0.3 * coarse);
    CHECK(estimate(body, Discrepancy<Rubber>{}) > 0.2 * coarse);
    for (long n : numbers_in(body.template groups_of<Quad4>())) CHECK(n > 0);
  });
}

/// A beam over which a load wanders from end to end.
template <class B>
auto loaded_beam(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {8, 1}, .cells = {48, 6}});
  auto body = three_laws(backend, mesh);
  body.clamp(mesh.boundary("left"));
  body.clamp(mesh.boundary("right"));
  body.set_damping(1);
  return body;
}
template <class TheBody>
void load_at(TheBody& body, double place) {
  std::vector<Point<2>> loads(static_cast<std::size_t>(body.nodes()));
  for (std::size_t i = 0; i < loads.size(); ++i) {
    auto const& p = body.mesh().nodes[i];
    if (p[1] > 0.99 && std::abs(p[0] - place) < 0.6) loads[i] = {0, -0.004};
  }
  body.set_loads(loads);
}
inline double place_at(double time) { return 4 - 3 * std::cos(0.25 * time); }

TEST_CASE("a budget is held within a tenth while a load wanders, where it is needed",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = loaded_beam(backend), fixed = loaded_beam(backend);
    constexpr double budget = 150;
    auto const rule = within<Linear, Turning, Rubber>(
        {.evaluations_per_step = budget, .stay = 16, .costs = some_costs});
    Adaptation adapt{rule};
    CentralDifference step;
    std::vector<Tag> first;
    double held = 0, by_first = 0, middle = 0;
    for (int k = 0; k < 120; ++k) {
      load_at(body, place_at(body.time()));
      step(body, 16, adapt);
      double const spent = evaluations_per_step(body, rule);
      if (k >= 2) {
        CHECK(spent <= budget);
        CHECK(spent >= 0.9 * budget);
      }
      if (k == 20) first = body.template groups_of<Quad4>();
      if (k < 20 || k % 10 != 0) continue;
      held += estimate(body, Discrepancy<Rubber>{});
      fixed.set_displacements(body.displacements());
      put_all_into<Linear>(fixed);
      for (int group : {1, 2}) {
        std::vector<Index> own;
        for (std::size_t e = 0; e < first.size(); ++e)
          if (first[e] == group) own.push_back(static_cast<Index>(e));
        group == 1 ? fixed.template assign<Turning>(own) : fixed.template assign<Rubber>(own);
      }
      by_first += estimate(fixed, Discrepancy<Rubber>{});
      middle = std::max(middle, place_at(body.time()));
    }
    CHECK(middle > 5);  // the load went over
    CHECK(held < 0.5 * by_first);
  });
}

TEST_CASE("an error is held while a load wanders, and room is given back", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = loaded_beam(backend);
    constexpr double error = 1e-6;
    auto const rule = within<Linear, Turning, Rubber>({.error = error, .costs = some_costs});
    Adaptation adapt{rule};
    CentralDifference step;
    double dearest = 0;
    for (int k = 0; k < 60; ++k) {
      load_at(body, place_at(body.time()));
      step(body, 16, adapt);
      CHECK(estimate(body, Discrepancy<Rubber>{}) <= error * (1 + 1e-12));
      dearest = std::max(dearest, evaluations_per_step(body, rule));
    }
    REQUIRE(dearest > 70);
    body.set_displacements(FieldOf<2>(static_cast<std::size_t>(body.nodes())));
    adapt.now(body);
    CHECK(evaluations_per_step(body, rule) == Approx(0.2 * 288));
  });
}

TEST_CASE("no element of a swinging beam switches more than once per half period", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {6, 1}, .cells = {18, 3}});
    auto const swing = [&](auto const& make) {
      auto body = three_laws(backend, mesh);
      body.clamp(mesh.boundary("left"));
      auto v = mesh.nodes;
      for (auto& p : v) p = {0, 0.004 * p[0] * p[0]};
      body.set_velocities(v);
      CentralDifference step;
      step(body);
      // Half periods by the tip's changes of direction.
      auto const tip = static_cast<std::size_t>(nodes_of(mesh.boundary("right")).front());
      auto adapt = make();
      int half_periods = 0;
      std::int64_t longest = 0, last = 0;
      bool up = true;
      while (half_periods < 6) {
        step(body, 8, adapt);
        bool const now = body.velocities()[tip][1] > 0;
        if (now != up) {
          ++half_periods;
          longest = std::max(longest, body.steps() - last);
          last = body.steps();
          up = now;
        }
      }
      auto const counts = switch_counts<Quad4>(body);
      return std::tuple{half_periods, longest, *std::ranges::max_element(counts)};
    };
    auto const never =
        swing([] { return Adaptation{cheapest<Linear, Rubber>({.tolerance = 1e3})}; });
    auto const stay = std::get<1>(never);
    auto const hasty = swing(
        [&] { return Adaptation{cheapest<Linear, Rubber>({.tolerance = 3e-8, .release = 1})}; });
    auto const calm = swing(
        [&] { return Adaptation{cheapest<Linear, Rubber>({.tolerance = 3e-8, .stay = stay})}; });
    auto const spending =
        swing([&] { return Adaptation{within<Linear, Rubber>({.error = 3e-7, .stay = stay})}; });

    CHECK(std::get<2>(never) == 0);
    CHECK(std::get<2>(hasty) > std::get<0>(hasty));
    CHECK(std::get<2>(calm) > 0);
    CHECK(std::get<2>(calm) <= std::get<0>(calm));
    CHECK(std::get<2>(spending) > 0);
    CHECK(std::get<2>(spending) <= std::get<0>(spending));
  });
}

TEST_CASE("what an element has counts for more than what it would get", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(12);
    auto const moves = [&](double release) {
      auto body = three_laws(backend, mesh);
      Adaptation adapt{within<Linear, Rubber>(
          {.evaluations_per_step = 100, .release = release, .costs = {0.5, 1}})};
      auto const u = uneven(mesh);
      Random random(3);
      for (int k = 0; k < 12; ++k) {
        auto w = u;
        auto const off = random.field<2>(u.size(), 0.002);
        for (std::size_t i = 0; i < u.size(); ++i)
          for (std::size_t c = 0; c < 2; ++c) w[i][c] += off[i][c];
        body.set_displacements(w);
        adapt.now(body);
      }
      double sum = 0;
      for (int n : switch_counts<Quad4>(body)) sum += n;
      return sum;
    };
    CHECK(moves(0.1) < 0.7 * moves(1));
  });
}

TEST_CASE("where a discrepancy is NaN an element stays", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {4, 4}, .cells = {4, 4}});
    auto u = uneven(mesh);
    u[12] = {3, 3};  // folds elements: neo-Hooke's law has no energy there
    auto const check = [&](auto const& rule) {
      auto body = three_laws(backend, mesh);
      body.set_displacements(u);
      auto const values = evaluate<Quad4>(body, Discrepancy<Rubber>{});
      Adaptation{rule}.now(body);
      auto const groups = body.template groups_of<Quad4>();
      int folded = 0;
      for (std::size_t e = 0; e < groups.size(); ++e) {
        folded += std::isnan(values[e]);
        CHECK((groups[e] == 0) == std::isnan(values[e]));
      }
      CHECK(folded > 0);
      CHECK(folded < 16);
    };
    check(cheapest<Linear, Rubber>({.tolerance = 1e-30}));
    check(within<Linear, Rubber>({.error = 1e-30}));
    check(within<Linear, Rubber>({.evaluations_per_step = 16}));

    auto body = three_laws(backend, mesh);
    put_all_into<Rubber>(body);
    body.set_displacements(u);
    auto const values = evaluate<Quad4>(body, In<Linear>{});
    Adaptation{within<Linear, Rubber>({.error = 1e9})}.now(body);
    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < groups.size(); ++e)
      CHECK((groups[e] == 2) == std::isnan(values[e]));
  });
}

TEST_CASE("a run that is saved and restored goes on as if nothing had happened, to the bit",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const rule =
        within<Linear, Turning, Rubber>({.error = 1e-8, .evaluations_per_step = 150, .stay = 24});
    auto body = loaded_beam(backend), again = loaded_beam(backend);
    CentralDifference step, other;
    Adaptation adapt{rule}, same{rule};
    load_at(body, 2);
    for (int k = 0; k < 100; ++k) {
      step(body);
      adapt(body);
    }
    std::stringstream stream;
    body.save(stream);
    again.load(stream);
    auto const before = body.template groups_of<Quad4>();
    for (int k = 0; k < 100; ++k) {
      step(body);
      adapt(body);
      other(again);
      same(again);
    }
    CHECK(body.template groups_of<Quad4>() != before);
    if constexpr (between_runs(1) == 0) CHECK(first_difference(body.state(), again.state()) == "");
    CHECK(again.template groups_of<Quad4>() == body.template groups_of<Quad4>());
  });
}

#if !defined(__CUDACC__) && defined(_OPENMP)
TEST_CASE("Reference and OpenMP decide alike", "[adaptation]") {
  auto const check = [](auto const& rule) {
    auto a = loaded_beam(Reference<double>{});
    auto b = loaded_beam(OpenMP<double>{});
    CentralDifference step, other;
    Adaptation adapt{rule}, same{rule};
    load_at(a, 2);
    load_at(b, 2);
    // Until strains are well above what they are rounded by.
    step(a, 40);
    other(b, 40);
    bool mixed = false;
    for (int k = 0; k < 30; ++k) {
      load_at(a, 2 + 0.1 * k);
      load_at(b, 2 + 0.1 * k);
      step(a, 8, adapt);
      other(b, 8, same);
      auto const groups = a.groups_of<Quad4>();
      CHECK(groups == b.groups_of<Quad4>());
      mixed = mixed || (numbers_in(groups)[0] > 5 && numbers_in(groups)[2] > 0);
    }
    CHECK(mixed);
  };
  check(within<Linear, Turning, Rubber>({.evaluations_per_step = 150}));
  check(within<Linear, Turning, Rubber>({.error = 1e-8}));
  check(cheapest<Linear, Turning, Rubber>({.tolerance = 1e-9}));
}
#endif

/// A clock that tests set.
struct TestClock {
  inline static double seconds = 0;
  static double read() { return seconds; }
};

TEST_CASE("choices that differ by a limit look each in their own time", "[adaptation]") {
  auto body = three_laws(Reference<double>{}, distorted_mesh<Quad4>(3));
  Adaptation one{within<Linear, Rubber>({.error = 1})}, other{within<Linear, Rubber>({.error = 2})};
  Adaptation costs{within<Linear, Rubber>({.error = 1, .costs = {0.5, 1}})};
  one(body);
  other(body);
  costs(body);
  auto const& looks = body.state().record.looks;
  REQUIRE(looks.size() == 3);
  // Of equal rules the second has the next number.
  CHECK(looks[1].adaptation != looks[0].adaptation + 1);
  CHECK(looks[2].adaptation != looks[0].adaptation + 1);
}

TEST_CASE("a budget in milliseconds follows what steps take", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = loaded_beam(backend);
    constexpr double budget = 3;  // ms
    WithinOptions<3> options{.milliseconds_per_step = budget, .costs = some_costs};
    options.clock = TestClock::read;
    auto const rule = within<Linear, Turning, Rubber>(options);
    Adaptation adapt{rule};
    CentralDifference step;
    double of_evaluation = 1e-5;  // s
    auto const seconds_per_step = [&] {
      return 5e-4 + of_evaluation * evaluations_per_step(body, rule);
    };
    auto const run = [&](int looks) {
      for (int k = 0; k < looks; ++k) {
        load_at(body, place_at(body.time()));
        for (int s = 0; s < 8; ++s) {
          step(body);
          TestClock::seconds += seconds_per_step();
          adapt(body);
        }
      }
    };
    run(1);
    CHECK(evaluations_per_step(body, rule) == Approx(0.2 * 288));  // nothing is known yet
    run(10);
    for (int k = 0; k < 40; ++k) {
      run(1);
      CHECK(1e3 * seconds_per_step() == Approx(budget).epsilon(0.1));
    }
    of_evaluation = 2e-5;  // the machine has become slower
    run(12);
    CHECK(1e3 * seconds_per_step() == Approx(budget).epsilon(0.1));

    // What was measured is in the state; a process that goes on begins to measure anew.
    auto again = loaded_beam(backend);
    std::stringstream stream;
    body.save(stream);
    again.load(stream);
    CHECK(first_difference(body.state(), again.state()) == "");
    auto const known = again.state().record.looks.front().seconds_per_evaluation;
    CHECK(known == Approx(3e-3 / evaluations_per_step(body, rule)).epsilon(0.1));
    Adaptation same{rule};
    CentralDifference other;
    TestClock::seconds += 1e6;  // between two processes
    for (int s = 0; s < 8; ++s) {
      other(again);
      same(again);
    }
    CHECK(again.state().record.looks.front().seconds_per_evaluation == known);
  });
}

TEST_CASE("under local steps a budget counts an element as often as its level is evaluated",
          "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    int const rows = B::orders_by_group ? 24 : 6;
    auto mesh = mesh::rectangle({.size = {8, 1}, .cells = {96, rows}});
    for (auto& p : mesh.nodes) p[0] = p[0] * (0.1 + 0.9 * p[0] / 8);
    auto body = three_laws(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.clamp(mesh.boundary("right"));
    body.set_damping(1);
    LocalSteps step;
    load_at(body, 1);
    step(body, 1);
    auto const counted = [&](auto& of) {
      auto const& parts = of.parts();
      auto const& table = parts.layout.template table<Quad4>();
      auto const groups = of.template groups_of<Quad4>();
      std::pair<double, double> sums;  // with levels, and without
      auto const bounds = table.elements.patch_bounds();
      std::size_t patch = 0;
      for (std::size_t k = 0; k < groups.size(); ++k) {
        auto const e = static_cast<std::size_t>(table.user_elements()[k]);
        while (static_cast<std::size_t>(bounds[patch + 1]) <= k) ++patch;
        double const cost = some_costs[groups[e]] / some_costs[2];
        sums.first += std::ldexp(cost, parts.schedule->patch_levels[0][patch]);
        sums.second += cost;
      }
      return sums;
    };
    auto const [least, without] = counted(body);
    REQUIRE(least > 1.5 * without);  // levels differ
    double const budget = 1.3 * least;
    auto const rule =
        within<Linear, Turning, Rubber>({.evaluations_per_step = budget, .costs = some_costs});
    for (int k = 0; k < 12; ++k) {
      load_at(body, 1 + 0.5 * k);
      step(body, 8);

      Adaptation{rule}.now(body);

      double const spent = counted(body).first;
      CHECK(spent <= budget * (1 + 1e-6));
      CHECK(spent >= 0.9 * budget);
      CHECK(evaluations_per_step(body, rule) == Approx(spent));
    }
    std::stringstream file;
    body.save(file);
    auto again = three_laws(backend, mesh);
    again.clamp(mesh.boundary("left"));
    again.clamp(mesh.boundary("right"));
    again.load(file);
    Adaptation{rule}.now(body);
    Adaptation{rule}.now(again);
    CHECK(again.template groups_of<Quad4>() == body.template groups_of<Quad4>());
    CHECK(evaluations_per_step(again, rule) == evaluations_per_step(body, rule));
  });
}

TEST_CASE("what sleeps stays, costs nothing, and leaves its budget to others", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    int const rows = B::orders_by_group ? 48 : 6;
    auto const mesh = mesh::rectangle({.size = {20, 0.05 * rows}, .cells = {200, rows}});
    auto const run = [&](auto... rules) {
      Body body{backend, mesh, soft, Group<Linear>{}, Group<Rubber>{}};
      auto u = mesh.nodes;
      for (auto& p : u) p = {0.05 * p[0], 0};
      body.set_displacements(u);
      for (char const* end : {"left", "right"}) body.clamp(mesh.boundary(end));
      for (char const* edge : {"bottom", "top"}) body.hold(mesh.boundary(edge), 2);
      auto v = mesh.nodes;
      for (auto& p : v) p = {p[0] < 0.3 ? 0.05 : 0.0, 0.0};
      body.set_velocities(v);
      CentralDifference step;
      Adaptation adapt{rules...};
      for (int k = 0; k < 48; ++k) {
        step(body);
        adapt(body);
      }
      return body;
    };
    auto body = run(sleep({.below = 1e-4, .for_steps = 16}));
    auto const asleep = asleep_elements<Quad4>(body);
    auto const sleeping = std::ranges::count(asleep, true);
    auto const awake = static_cast<long>(asleep.size()) - sleeping;
    REQUIRE(sleeping > 0);
    REQUIRE(awake > 0);
    // So much that sleeping elements, which are strained as well, would be given some of it.
    long const costly = awake * 4 / 5;
    double const budget = 0.5 * static_cast<double>(awake + costly);
    auto const rule = within<Linear, Rubber>({.evaluations_per_step = budget, .costs = {0.5, 1}});

    Adaptation{rule}.now(body);

    auto const groups = body.template groups_of<Quad4>();
    for (std::size_t e = 0; e < groups.size(); ++e)
      if (asleep[e]) CHECK(groups[e] == 0);
    CHECK(std::ranges::count(groups, 1) == costly);
    CHECK(evaluations_per_step(body, rule) == Approx(budget));

    auto const both =
        run(cheapest<Linear, Rubber>({.tolerance = 1e3}), sleep({.below = 1e-4, .for_steps = 16}));
    CHECK(std::ranges::count(asleep_elements<Quad4>(both), true) > 0);
  });
}

TEST_CASE("costs are counted alike everywhere, or measured", "[adaptation]") {
  auto const mesh = distorted_mesh<Quad4>(6);
  std::array<double, 3> first{};
  on_each_backend<FewBackends>([&]<class B>(B const& backend) {
    auto body = three_laws(backend, mesh);
    auto const counted =
        detail::counted_costs(body.parts(), detail::TypeList<Linear, Turning, Rubber>{});
    if (first[2] == 0) first = counted;
    CHECK(counted == first);
    CHECK(counted[0] < counted[1]);
    CHECK(counted[1] < counted[2]);
    CHECK(counted[2] == 1);
    auto const measured =
        measure_costs<Coarse, Rubber>(Body{backend, mesh, soft, Group<Rubber>{}, Group<Coarse>{}});
    CHECK(measured[0] > 0);
    CHECK(measured[1] == 1);
    auto const rule = within<Linear, Turning, Rubber>({.evaluations_per_step = 30});
    put_all_into<Turning>(body);
    CHECK(evaluations_per_step(body, rule) ==
          Approx(static_cast<double>(mesh.elements<Quad4>().size()) * counted[1]));
  });
}

TEST_CASE("limits and costs out of range are refused", "[adaptation]") {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const infinite = std::numeric_limits<double>::infinity();
  for (double bad : {nan, -1.0, 0.0}) {
    CHECK_THROWS_WITH((cheapest<Linear, Rubber>({.tolerance = bad})),
                      says("cheapest: tolerance is"));
    CHECK_THROWS_WITH((within<Linear, Rubber>({.error = bad})), says("within: error is"));
    CHECK_THROWS_WITH((within<Linear, Rubber>({.evaluations_per_step = bad})),
                      says("within: evaluations_per_step is"));
    CHECK_THROWS_WITH((within<Linear, Rubber>({.milliseconds_per_step = bad})),
                      says("within: milliseconds_per_step is"));
    CHECK_THROWS_WITH((within<Linear, Rubber>({.error = 1, .release = bad})), says("release is"));
    CHECK_THROWS_WITH((within<Linear, Rubber>({.error = 1, .costs = {1, bad}})),
                      says("the cost of group 1 is"));
  }
  CHECK_THROWS_WITH((cheapest<Linear, Rubber>({.tolerance = infinite})), says("positive energy"));
  CHECK_THROWS_WITH((cheapest<Linear, Rubber>({.tolerance = 1, .release = 1.5})),
                    says("release is"));
  CHECK_THROWS_WITH((cheapest<Linear, Rubber>({.tolerance = 1, .stay = -1})), says("stay is -1"));
  CHECK_THROWS_WITH((within<Linear, Rubber>({})), says("there is no limit"));
  CHECK_THROWS_WITH((within<Linear, Rubber>({.error = 1, .costs = {2, 1}})),
                    says("list groups from cheap to costly"));
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = three_laws(backend, distorted_mesh<Quad4>(3));
    auto const groups = body.template groups_of<Quad4>();
    Adaptation wrong{within<Rubber, Linear>({.error = 1e-9})};
    CHECK_THROWS_WITH(wrong.now(body), says("list groups from cheap to costly, or give costs"));
    CHECK(body.template groups_of<Quad4>() == groups);
  });
}

}  // namespace pliant::test::choice_suite
