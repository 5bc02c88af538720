#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include <pliant/law/decorators/viscosity.hpp>

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// Changes of the mesh: new nodes, hanging nodes, state, layout and groups. The rate counts the elements before.
namespace pliant::bench {

/// Of elements, by the type.
using Lists = std::vector<std::vector<Index>>;

/// The first elements of a mesh.
inline std::vector<Index> first_elements(std::size_t count) {
  std::vector<Index> marked;
  for (std::size_t e = 0; e < count; ++e) marked.push_back(static_cast<Index>(e));
  return marked;
}

/// Elements all over a mesh: each of so many.
inline std::vector<Index> each_of(std::size_t elements, Index distance) {
  std::vector<Index> marked;
  for (Index e = 0; e < static_cast<Index>(elements); e += distance) marked.push_back(e);
  return marked;
}

/// A tenth of a mesh that nobody has refined, whose refinement tree is made too.
template <class E, class B>
void time_refinement(benchmark::State& state, B const& backend, int cells) {
  auto const fresh = [&] { return shaken_body<Usual<E, SaintVenantKirchhoff>>(backend, cells); };
  Lists const marked{first_elements(element_count<E>(cells) / 10)};
  for (auto _ : state) {
    auto body = fresh();
    state.SetIterationTime(seconds(backend, [&] { refine(body, marked); }));
  }
  auto body = fresh();
  report_elements(state, body);
}

/// What a change of a mesh has to carry, or to undo, or stands beside.
enum class Beside {
  nothing,
  half,            // the first half of the mesh is refined, and stays so
  boundary,        // a pressure at the top, and a right end that is driven
  memory,          // what quadrature points keep
  listener,        // a simulator's array, with a value for each node
  listener_there,  // the same in the backend's memory, and one with a value for each element
  marks_there,     // nothing, and elements are marked in the backend's memory
  steps,  // nothing, and sixteen steps are counted, with what the first needs to know of the mesh
  local_steps,  // the same of local time steps
  sleep         // all patches sleep; steps until they do so again are counted
};
inline std::string in_words(Beside beside) {
  switch (beside) {
    case Beside::half:
      return ", beside a half that is refined";
    case Beside::boundary:
      return ", pressed and driven";
    case Beside::memory:
      return ", viscous";
    case Beside::listener:
      return ", and carry an array";
    case Beside::listener_there:
      return ", and carry arrays in the backend's memory";
    case Beside::marks_there:
      return ", marked in the backend's memory";
    case Beside::steps:
      return ", and 16 steps";
    case Beside::local_steps:
      return ", and 16 macro steps";
    case Beside::sleep:
      return ", asleep, and steps until it sleeps again";
    default:
      return "";
  }
}

template <class F, class B>
auto body_to_change(B const& backend, int cells) {
  using E = typename F::element;
  if constexpr (internal_variables_of<F> > 0) {
    auto const mesh = mesh_of<E>(cells);
    Body body{backend, mesh, soft,
              Group<F>{typename F::template law<double>{{3, 2}, {0.5}, {0.1}}}};
    body.clamp(mesh.boundary("left"));
    body.set_displacements(shaken(mesh.nodes, 1, 1));
    return body;
  } else {
    return shaken_body<F>(backend, cells);
  }
}

/// Some elements of a mesh in which one was refined before, or their children, and no others, back to what they were.
template <class F, class B>
void time_change(benchmark::State& state, B const& backend, int cells,
                 std::vector<Index> const& marked, bool back, Beside beside) {
  using E = typename F::element;
  auto body = body_to_change<F>(backend, cells);
  report_elements(state, body);
  if (beside == Beside::boundary) {
    body.press(body.mesh().boundary("top"), 10);
    body.drive(body.mesh().boundary("right"), [](double time) {
      Point<E::dim> u{};
      u[0] = time;
      return u;
    });
  }
  std::vector<double> temperature(static_cast<std::size_t>(body.nodes()), 1.0);
  if (beside == Beside::listener)
    body.on_change([&](auto const& change) {
      temperature = change.transfer.carry_nodes(std::move(temperature));
    });
  auto temperature_there = upload(backend, temperature);
  auto stiffness_there =
      upload(backend, std::vector<double>(static_cast<std::size_t>(element_count<E>(cells)), 2.0));
  if (beside == Beside::listener_there)
    body.on_backend_change([&](auto const& change) {
      temperature_there = change.carry_nodes(temperature_there);
      stiffness_there = change.carry_elements(stiffness_there);
    });
  CentralDifference step;
  LocalSteps local;
  auto adapt = Adaptation{sleep({.below = 1e6, .for_steps = 2})}.every(1);
  auto const go_on = [&] {
    if (beside == Beside::sleep) step(body, 4, adapt);
    if (beside == Beside::steps) step(body, 16);
    if (beside == Beside::local_steps) local(body, 16);
  };
  auto const elements = static_cast<Index>(element_count<E>(cells));
  Index const half = beside == Beside::half ? elements / 2 : 0;
  if (half > 0) refine(body, {first_elements(static_cast<std::size_t>(half))});
  Index const last = elements - half - 1;  // those that are not refined come first
  Lists const marked_lists{marked};
  // change(lists) takes so many seconds, with what else is counted.
  auto const seconds_of = [&](Lists const& lists, auto const& change) {
    if (beside != Beside::marks_there)
      return seconds(backend, [&] {
        change(lists);
        go_on();
      });
    auto const there = upload(backend, lists[0]);
    std::vector<ElementsThere> const elements{{there.data(), static_cast<Index>(there.size())}};
    return seconds(backend, [&] { change(elements); });
  };
  auto const children = [&] {
    std::vector<Index> found;
    auto const levels = refinement_levels<E>(body);
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] > 0) found.push_back(static_cast<Index>(e));
    return found;
  };
  // Those of a list of children behind so many: new ones follow others.
  auto const behind = [](std::vector<Index> const& all, std::ptrdiff_t others) {
    return Lists{{all.begin() + others, all.end()}};
  };
  auto const of_half = static_cast<std::ptrdiff_t>(children().size());
  for (auto _ : state) {
    refine(body, {{last}});
    auto const others = static_cast<std::ptrdiff_t>(children().size());
    go_on();
    double const there = seconds_of(marked_lists, [&](auto const& lists) { refine(body, lists); });
    Lists const made = behind(children(), others);
    double const again = seconds_of(made, [&](auto const& lists) { coarsen(body, lists); });
    coarsen(body, behind(children(), of_half));
    state.SetIterationTime(back ? again : there);
  }
  if (beside == Beside::sleep && asleep(body).patches == 0) state.SkipWithError("nothing sleeps");
}

/// The mean of so many changes, there and back, with what the host does so as not to fall behind without end.
template <class F, class B>
void time_many_changes(benchmark::State& state, B const& backend, int cells,
                       std::vector<Index> const& marked) {
  constexpr int rounds = 300;
  auto body = body_to_change<F>(backend, cells);
  report_elements(state, body);
  Lists const there{marked};
  refine(body, there);
  std::vector<Index> made;
  auto const levels = refinement_levels<typename F::element>(body);
  for (std::size_t e = 0; e < levels.size(); ++e)
    if (levels[e] > 0) made.push_back(static_cast<Index>(e));
  Lists const back{made};
  coarsen(body, back);
  for (auto _ : state)
    state.SetIterationTime(seconds(backend,
                                   [&] {
                                     for (int round = 0; round < rounds; ++round) {
                                       refine(body, there);
                                       coarsen(body, back);
                                     }
                                   }) /
                           (2 * rounds));
}

inline void add_refinements() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const one = [&]<class E>(E, double elements) {
      int const cells = cells_for<E>(elements);
      add<Usual<E, SaintVenantKirchhoff>, T>(
          "refine", name, cells,
          [backend, cells](benchmark::State& state) { time_refinement<E>(state, backend, cells); });
      auto const change = [&]<Beside beside = Beside::nothing>(std::string const& what,
                                                               std::vector<Index> const& marked) {
        using F = std::conditional_t<beside == Beside::memory,
                                     Usual<E, Prony<SaintVenantKirchhoff>::template law>,
                                     Usual<E, SaintVenantKirchhoff>>;
        for (bool const back : {false, true})
          add<F, T>((back ? "coarsen " : "refine ") + what + in_words(beside), name, cells,
                    [=](benchmark::State& state) {
                      time_change<F>(state, backend, cells, marked, back, beside);
                    });
      };
      std::size_t const count = element_count<E>(cells);
      change("two", first_elements(2));
      change("a tenth", first_elements(count / 10));
      change.template operator()<Beside::half>("two", first_elements(2));
      if (elements < 1e6) return;
      change("a ten thousandth", first_elements(count / 10000));
      change("a hundredth", first_elements(count / 100));
      change("each hundredth", each_of(count, 100));
      if constexpr (std::same_as<E, Tet4>) {
        auto const change_often = [&](std::string const& what, std::vector<Index> const& marked) {
          using F = Usual<E, SaintVenantKirchhoff>;
          add_once<F, T>("refine or coarsen " + what + ", of 600 changes", name, cells,
                         [=](benchmark::State& state) {
                           time_many_changes<F>(state, backend, cells, marked);
                         });
        };
        change_often("two", first_elements(2));
        change_often("each hundredth", each_of(count, 100));
        auto const change_beside = [&]<Beside beside>() {
          change.template operator()<beside>("two", first_elements(2));
          change.template operator()<beside>("each hundredth", each_of(count, 100));
          change.template operator()<beside>("a tenth", first_elements(count / 10));
        };
        change_beside.template operator()<Beside::boundary>();
        change_beside.template operator()<Beside::memory>();
        change_beside.template operator()<Beside::listener>();
        change_beside.template operator()<Beside::listener_there>();
        change_beside.template operator()<Beside::marks_there>();
        change_beside.template operator()<Beside::steps>();
        change_beside.template operator()<Beside::sleep>();
        change.template operator()<Beside::steps>("each ten thousandth", each_of(count, 10000));
        change.template operator()<Beside::local_steps>("each ten thousandth",
                                                        each_of(count, 10000));
      }
    };
    one(Tri3{}, 2e4);
    one(Quad4{}, 2e4);
    one(Tet4{}, 2e4);
    one(Hex8{}, 2e4);
    one(Tet10{}, 2e4);
    one(Tet10{}, 2.5e5);
    one(Tet4{}, 1e6);
  });
}

}  // namespace pliant::bench
