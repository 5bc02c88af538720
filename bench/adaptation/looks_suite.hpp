#pragma once

#include <set>

#include "solver/step_suite.hpp"

// What looks cost beside the steps between them: where forces tell that no element may act, where they flag a
// twentieth of the patches, none of whose elements moves, and where every element is looked at, since its criterion says
// no bound.
namespace pliant::bench {

inline constexpr int steps_to_look = 8;

/// Edge lengths by a criterion that says no bound.
struct Unbounded {
  static constexpr Unit unit = Unit::one;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return EdgeLengthRatio{}(e);
  }
};

/// The share of a table's patches that have elements in a cube at the corner of the unit cube.
template <class TheBody>
double patches_in_corner(TheBody& body, double size) {
  auto const& table = std::get<0>(body.parts().layout.tables);
  auto const& mesh = body.mesh();
  auto const& elements = mesh.template elements<Tet4>();
  std::set<Index> patches;
  for (std::size_t e = 0; e < table.user_elements().size(); ++e) {
    std::array<double, 3> middle{};
    for (Index node : elements[static_cast<std::size_t>(table.user_elements()[e])])
      for (std::size_t k = 0; k < 3; ++k)
        middle[k] += mesh.nodes[static_cast<std::size_t>(node)][k] / 4;
    if (std::ranges::max(middle) < size)
      patches.insert(static_cast<Index>(
          std::ranges::upper_bound(table.elements.patch_bounds(), static_cast<Index>(e)) -
          table.elements.patch_bounds().begin()));
  }
  return static_cast<double>(patches.size()) / table.elements.patch_count();
}

enum class Flagged { none, some, unbounded };

template <class B>
void time_looks(benchmark::State& state, B const& backend, int cells, bool looks, Flagged flagged) {
  using Cheap = Usual<Tet4, Hooke>;
  using Dear = Usual<Tet4, SaintVenantKirchhoff>;
  auto& [body, step, share] = made_once([&] {
    auto b = shaken_body<Cheap, Dear>(backend, cells, 0.1);
    double share = 0;
    if (flagged == Flagged::some) {
      double size = 0.05;
      while ((share = patches_in_corner(b, size)) < 0.05) size += 0.005;
      Adaptation{when<Cheap>(inside(StrainNorm{}, Box{{-1.0, -1.0, -1.0}, {size, size, size}}))
                     .above(-1)
                     .template become<Dear>()}
          .now(b);
    }
    auto s = bare_steps(b);
    return std::tuple{std::move(b), s, share};
  });
  auto const run = [&, &b = body, &s = step](auto adapt) {
    adapt.every(steps_to_look);
    s(b, 4 * steps_to_look, adapt);
    measure_repeats(state, backend, [&](int times) {
      if (looks)
        s(b, times * steps_to_look, adapt);
      else
        s(b, times * steps_to_look);
    });
  };
  auto const never = [](auto criterion) {
    return Adaptation{when<Cheap>(criterion).above(1e30).template become<Dear>(),
                      when<Dear>(criterion).below(-1).template become<Cheap>()};
  };
  if (flagged == Flagged::unbounded)
    run(never(Unbounded{}));
  else
    run(never(EdgeLengthRatio{}));
  report_elements(state, body, steps_to_look);
  state.counters["flagged"] = share;
}

inline void add_looks() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    int const cells = usual_cells<Tet4, B>();
    auto const one = [&](char const* what, bool looks, Flagged flagged) {
      add<Usual<Tet4, Hooke>, T>(what, name, cells, [=](benchmark::State& state) {
        time_looks(state, backend, cells, looks, flagged);
      });
    };
    one("8 steps", false, Flagged::none);
    one("8 steps+look", true, Flagged::none);
    one("8 steps, two laws", false, Flagged::some);
    one("8 steps+look, 5 % flagged", true, Flagged::some);
    one("8 steps+look at all", true, Flagged::unbounded);
  });
}

}  // namespace pliant::bench
