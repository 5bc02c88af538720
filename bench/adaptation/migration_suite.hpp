#pragma once

#include <algorithm>
#include <memory>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Checks of an adaptation: one in which no element changes its group, and one in which the same 1% of
// elements, scattered over the body, go to the other group and back at the next check.
namespace pliant::bench {

template <class E>
using Cheaper = Usual<E, Hooke>;
template <class E>
using Better = Usual<E, SaintVenantKirchhoff>;

/// So deformed that neither law nor place tells which elements are stretched most.
template <class E, class B>
auto two_laws(B const& backend, int cells) {
  auto body = shaken_body<Cheaper<E>, Better<E>>(backend, cells);
  body.set_displacements(noise(body.mesh().nodes, 1));
  return body;
}

/// The edge length ratio above which a share of elements lies.
template <class E, class TheBody>
double ratio_exceeded_by(double share, TheBody& body) {
  auto values = evaluate<E>(body, EdgeLengthRatio{});
  auto const limit = values.begin() +
                     static_cast<std::ptrdiff_t>((1 - share) * static_cast<double>(values.size()));
  std::ranges::nth_element(values, limit);
  return *limit;
}

template <class E>
auto exchange_above(double ratio) {
  auto const far = EdgeLengthRatio{};
  return Adaptation{when<Cheaper<E>>(far).above(ratio).template become<Better<E>>(),
                    when<Better<E>>(far).above(ratio).template become<Cheaper<E>>()};
}

/// How many elements changed their group so far.
template <class TheBody>
double moves(TheBody const& body) {
  double sum = 0;
  for (auto const& entry : ledger(body)) sum += entry.elements;
  return sum;
}

template <class E, class B>
void time_check(benchmark::State& state, B const& backend, int cells, double moving) {
  auto& [body, adapt] = made_once([&] {
    auto b = two_laws<E>(backend, cells);
    auto a = exchange_above<E>(moving > 0 ? ratio_exceeded_by<E>(moving, b) : 1e30);
    return std::pair{std::move(b), a};
  });
  measure_calls(state, backend, [&b = body, &a = adapt] { a.now(b); });
  report_elements(state, body);
  double const before = moves(body);
  adapt.now(body);
  state.counters["moved"] = moves(body) - before;
}

/// Forces of the body that make() makes.
template <class B, class Make>
void time_forces_of(benchmark::State& state, B const& backend, Make const& make) {
  auto& body = made_once(make);
  measure(state, backend, [&] {
    forget_forces(body.parts());
    evaluate_forces(body.parts());
  });
  report_elements(state, body);
}

/// While half of the elements, at random, follow the other law.
template <class E, class B>
void time_mixed_force(benchmark::State& state, B const& backend, int cells) {
  time_forces_of(state, backend, [&] {
    auto b = two_laws<E>(backend, cells);
    exchange_above<E>(ratio_exceeded_by<E>(0.5, b)).now(b);
    return b;
  });
}

/// While all elements follow the first of the laws; the others are compiled in, and have none.
template <class... Fs, class B>
void time_first_law(benchmark::State& state, B const& backend, int cells) {
  time_forces_of(state, backend, [&] { return shaken_body<Fs...>(backend, cells); });
}

inline void add_migrations() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    auto const all = [&]<class E>(E) {
      int const cells = usual_cells<E, B>();
      auto const add_one = [&](char const* what, auto run) {
        add<Better<E>, T>(what, name, cells,
                          [backend, cells, run](benchmark::State& s) { run(s, backend, cells); });
      };
      add_one("check", [](auto& s, auto const& b, int n) { time_check<E>(s, b, n, 0); });
      add_one("migration", [](auto& s, auto const& b, int n) { time_check<E>(s, b, n, 0.01); });
      add_one("mixed_force", [](auto& s, auto const& b, int n) { time_mixed_force<E>(s, b, n); });
      add_one("one law", [](auto& s, auto const& b, int n) { time_first_law<Better<E>>(s, b, n); });
      add_one("second law", [](auto& s, auto const& b, int n) {
        time_first_law<Better<E>, Usual<E, NeoHookean>>(s, b, n);
      });
    };
    if (role == Role::scalar) return;
    if constexpr (sizeof(T) == 4) {
      all(Tet4{});
      all(Hex8{});
    } else {
      all(Quad4{});
    }
  });
}

}  // namespace pliant::bench
