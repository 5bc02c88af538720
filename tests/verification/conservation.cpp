#include <algorithm>
#include <functional>

#include <pliant/solve.hpp>
#include <pliant/solver/local_steps.hpp>

#include "verification/support/statics.hpp"

// What integrators keep of a body that flies, turns and trembles freely, and of one that swings for a million steps.
namespace pliant::verification {

template <template <class> class L>
using Plate = Formulation<Quad4, Gauss<2>, L>;

template <class F>
auto plate() {
  return body_of<F>(mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}), {1e6, 0.3, 1000});
}

/// One of the library's schemes, chosen while the program runs: bodies compile one.
struct AnyScheme {
  std::function<StepRule(double, double)> formula;
  static constexpr int order = 2;
  static constexpr bool looks_back = true;
  static constexpr char const* name = "AnyScheme";
  void check() const {}
  StepRule rule(double h, double h_before) const { return formula(h, h_before); }
};

struct Kept {
  double energy, momentum, spin;  // J, kg m/s, and about the origin kg m²/s
};
template <class TheBody>
Kept kept_by(TheBody& body) {
  auto const u = body.displacements(), v = body.velocities();
  Point<2> p{};
  double spin = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    double const m = body.parts().layout.mass_list()[i];
    Point<2> const x{body.mesh().nodes[i][0] + u[i][0], body.mesh().nodes[i][1] + u[i][1]};
    for (std::size_t k = 0; k < 2; ++k) p[k] += m * v[i][k];
    spin += m * (x[0] * v[i][1] - x[1] * v[i][0]);
  }
  return {total_energy_of(body.parts()), std::hypot(p[0], p[1]), spin};
}

/// A flight of 2 s, about 30 of the slowest oscillations. Bounds are of the change over the start: of the energy, and of
/// the spin; momentum is kept to rounding by all.
template <class Advance>
void flight(Table& table, char const* integrator, double steps, double energy, double spin,
            Advance const& advance) {
  auto body = plate<Plate<SaintVenantKirchhoff>>();
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) {
    auto const& x = body.mesh().nodes[i];
    v[i] = {3 - 4 * (x[1] - 0.25) + 0.5 * (x[0] - 0.5), 1 + 4 * (x[0] - 0.5)};
  }
  body.set_velocities(v);
  double const step = steps * stable_step(body);
  auto const before = kept_by(body);
  advance(body, step, static_cast<int>(std::ceil(2 / step)));
  auto const after = kept_by(body);
  std::string const meshes = "4 x 2, steps of " + number(steps) + " stable ones";
  std::string const by = std::string(integrator) + ", ";
  auto const row = [&](char const* what, double value, double bound) {
    table.compare({by + what, name_of<Plate<SaintVenantKirchhoff>>(), meshes}, value,
                  within(bound, 0));
  };
  row("energy", after.energy / before.energy - 1, energy);
  row("momentum", after.momentum / before.momentum - 1, 1e-8);
  row("spin", after.spin / before.spin - 1, spin);
}

void flights(Table& table) {
  auto const explicitly = [](auto& body, double step, int steps) {
    CentralDifference{{.step = step}}(body, steps);
  };
  flight(table, "CentralDifference", 0.3, 1e-4, 1e-12, explicitly);
  flight(table, "CentralDifference", 0.9, 1e-3, 1e-12, explicitly);
  auto const implicitly = [](auto const& scheme) {
    return [=](auto& body, double step, int steps) {
      AnyScheme const any{[scheme](double h, double before) { return scheme.rule(h, before); }};
      Implicit{any, {.step = step, .mass = MassMatrix::lumped, .tolerance = 1e-11}}(body, steps);
    };
  };
  flight(table, "Newmark", 1, 5e-4, 2e-3, implicitly(Newmark{}));
  flight(table, "Newmark", 10, 2e-2, 1e-1, implicitly(Newmark{}));
  flight(table, "GeneralizedAlpha, 0.8", 1, 5e-4, 2e-4, implicitly(GeneralizedAlpha{}));
  flight(table, "GeneralizedAlpha, 0.8", 10, 2e-2, 2e-3, implicitly(GeneralizedAlpha{}));
  flight(table, "BDF2", 1, 5e-3, 5e-3, implicitly(BDF2{}));
  flight(table, "BDF2", 10, 1e-1, 3e-1, implicitly(BDF2{}));
  flight(table, "BackwardEuler", 1, 1e-1, 5e-1, implicitly(BackwardEuler{}));
  flight(table, "BackwardEuler", 10, 3e-1, 1.5, implicitly(BackwardEuler{}));
}

/// The slope of the energy's means over 1,000 steps, over the energy, per step, of steps of 0.3 of the stable one.
template <template <class> class L>
void long_swing(Table& table) {
  int const steps = table.full() ? 1000000 : 50000;
  auto body = plate<Plate<L>>();
  body.clamp(body.mesh().boundary("left"));
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = {0, 0.5 * square(body.mesh().nodes[i][0])};
  body.set_velocities(v);
  double const energy = total_energy_of(body.parts());
  CentralDifference step{{.step = 0.3 * stable_step(body)}};
  double n = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  while (body.steps() < steps) {
    double mean = 0;
    for (int k = 0; k < 100; ++k) {
      step(body, 10);
      mean += total_energy_of(body.parts()) / (100 * energy);
    }
    auto const x = static_cast<double>(body.steps());
    n += 1;
    sum_x += x;
    sum_y += mean;
    sum_xx += x * x;
    sum_xy += x * mean;
  }
  double const slope = (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
  // Windows do not hold whole swings: over fewer steps that counts for more.
  table.compare(
      {"free swing, slope of the energy per step", name_of<Plate<L>>(), number(steps) + " steps"},
      slope, within(table.full() ? 1e-12 : 4e-11, 0));
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant::verification;
  Table table("What integrators keep", argc, argv);
  flights(table);
  long_swing<pliant::Hooke>(table);
  long_swing<pliant::SaintVenantKirchhoff>(table);
  return table.finish();
}
