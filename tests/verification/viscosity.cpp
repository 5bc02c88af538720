#include "verification/support/statics.hpp"

// REFERENCES, section 13: viscous laws against closed forms worked out here. A bar is confined sideways and
// stretched so that its Green strain grows with the time, E11 = e t, and then stays; over Saint
// Venant-Kirchhoff the elastic stress S_L = k E11, k = λ + 2μ, is linear in time, and all that flows has a
// closed form at any step.
namespace pliant::verification {

double const lambda = 3, mu = 2, k = lambda + 2 * mu;  // Pa
double const length = 2, rate = 0.3, pull = 1;         // m, 1/s, s
double const eta = 0.8;                                // Pa s

double strain(double t) { return rate * std::min(t, pull); }
double stretch(double t) { return std::sqrt(1 + 2 * strain(t)); }

/// What a branch of the share 1 carries, as part of k: its stress grows as the strain does, and decays.
double branch(double tau, double t) {
  double const pulled = std::min(t, pull);
  return rate * tau * -std::expm1(-pulled / tau) * std::exp(-(t - pulled) / tau);
}

/// P11 at the end of the bar after steps of a size.
template <class F>
double drawn(LawOf<F> const& law, double until, int steps) {
  using E = typename F::element;
  Mesh<E> mesh;
  if constexpr (E::dim == 2)
    mesh = mesh::rectangle<E>({.size = {length, 1}, .cells = {1, 1}});
  else
    mesh = mesh::box<E>({.size = {length, 1, 1}, .cells = {1, 1, 1}});
  auto body = body_of<F>(mesh, law);
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"), [](double t) {
    Point<E::dim> u{};
    u[0] = length * (stretch(t) - 1);
    return u;
  });
  CentralDifference step{{.step = until / steps}};
  step(body, steps);
  auto const forces = body.forces();
  double sum = 0;
  for (Index node : nodes_of(mesh.boundary("right")))
    sum -= forces[static_cast<std::size_t>(node)][0];
  return sum;
}

template <class F, class Expected>
void rows(Table& table, char const* problem, LawOf<F> const& law, Expected const& expected) {
  for (double t : {0.5, 1.0, 1.75}) {
    auto const runs = on_meshes({7, 28}, 1, [&](int n) { return std::array{drawn<F>(law, t, n)}; });
    table.compare(
        {"13, " + std::string(problem) + ", P11 at " + number(t) + " s", name_of<F>(), "n steps"},
        runs, 0, within(1e-12, stretch(t) * expected(t)));
  }
}

template <Element E>
void bars(Table& table) {
  SaintVenantKirchhoff<double> const elastic{lambda, mu};
  rows<Formulation<E, Full<E>, KelvinVoigt<SaintVenantKirchhoff>::template law>>(
      table, "dashpot beside a spring", {elastic, eta},
      [](double t) { return k * strain(t) + (t <= pull ? eta * rate : 0); });
  rows<Formulation<E, Full<E>, Prony<SaintVenantKirchhoff>::template law>>(
      table, "standard linear solid", {elastic, {0.7}, {0.4}},
      [](double t) { return k * (strain(t) + 0.7 * branch(0.4, t)); });
  rows<Formulation<E, Full<E>, Prony<SaintVenantKirchhoff, 2>::template law>>(
      table, "two branches", {elastic, {0.7, 0.3}, {0.4, 2.5}},
      [](double t) { return k * (strain(t) + 0.7 * branch(0.4, t) + 0.3 * branch(2.5, t)); });
}

/// One element, let go: u'' + 2 ζ ω u' + ω² u = 0 with half its mass at the free end. Explicit steps take
/// the rate half a step late: order 1.
void swing(Table& table) {
  using F = Formulation<Hex8, Gauss<2>, KelvinVoigt<Hooke>::law>;
  double const omega = std::sqrt(2 * k) / length, zeta = eta / (2 * k) * omega;
  double const bent = omega * std::sqrt(1 - zeta * zeta), until = 4, start = 1e-6;
  auto const runs = on_meshes({100, 200, 400}, 1, [&](int n) {
    auto const mesh = mesh::box<Hex8>({.size = {length, 1, 1}, .cells = {1, 1, 1}});
    auto body = body_of<F>(mesh, {{lambda, mu}, eta});
    body.clamp(mesh.boundary("left"));
    body.hold(mesh.boundary("right"), 0b110);
    auto u = body.displacements();
    for (Index node : nodes_of(mesh.boundary("right")))
      u[static_cast<std::size_t>(node)][0] = start;
    body.set_displacements(u);
    CentralDifference step{{.step = until / n}};
    step(body, n);
    return std::array{body.displacements()[node_at(mesh, {length, 0, 0})][0] / start};
  });
  double const exact = std::exp(-zeta * omega * until) *
                       (std::cos(bent * until) + zeta * omega / bent * std::sin(bent * until));
  table.approach({"13, a weight on dashpot and spring, u at 4 s", name_of<F>(), "n steps"}, runs, 0,
                 within(0, exact), 1);
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  using namespace pliant::verification;
  Table table("Viscous bars (13)", argc, argv);
  bars<pliant::Tet4>(table);
  bars<pliant::Quad4>(table);
  bars<pliant::Hex8>(table);
  swing(table);
  return table.finish();
}
#endif
