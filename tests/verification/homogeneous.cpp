#include <numbers>

#include "support/fields.hpp"
#include "support/meshes.hpp"
#include "verification/support/statics.hpp"

// Uniform states (REFERENCES, section 6, and closed forms worked out here from the printed energies): the
// boundary of a distorted mesh is moved by u = H X, its inner nodes find their places, and the energy and
// the reactions are those of the law.
namespace pliant::verification {

/// Per rest volume, in Pa: W, and P by rows. Only P11, P22, P33, P12, P21 are not zero.
struct State {
  double energy, p11, p22, p33, p12, p21;
};

double const stretch = 1.2, gradient = 0.4;        // l1 and g
double const lambda = 3, mu = 2, bulk = 13.0 / 3;  // of Elastic{5.2, 0.3}
double const printed_bulk = 5;                     // that section 6 puts beside mu = 2

template <class F>
State measured(LawOf<F> const& law, Tensor<double, 3> const& h,
               std::vector<std::array<double, element_values<F>>> const& values) {
  auto const mesh = test::distorted_mesh<typename F::element>(3);
  Body body{Reference<double>{}, mesh, Elastic{1, 0, 1}, Group<F>{law, values}};
  auto u = test::uniform(mesh.nodes, h);
  auto const outer = test::boundary_nodes(mesh);
  test::Random random(1);
  for (Index i = 0; i < body.nodes(); ++i)
    if (!std::ranges::binary_search(outer, i))
      for (double& x : u[static_cast<std::size_t>(i)]) x += 0.01 * random();
  body.set_displacements(u);
  body.clamp(outer);
  auto const report = solve_static(body);
  // The mean stress is the sum of reaction times place, for a volume of 1.
  double p[3][3]{};
  auto const forces = body.forces();
  for (Index n : outer)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        p[i][k] -=
            forces[static_cast<std::size_t>(n)][i] * mesh.nodes[static_cast<std::size_t>(n)][k];
  return {report.energy, p[0][0], p[1][1], p[2][2], p[0][1], p[1][0]};
}

template <class F>
void compare(Table& table, std::string const& state, LawOf<F> const& law,
             Tensor<double, 3> const& h, State const& expected, double digits,
             std::vector<double> const& value = {}) {
  std::vector<std::array<double, element_values<F>>> values;
  if (!value.empty()) {
    values.resize(test::distorted_mesh<typename F::element>(3)
                      .template elements<typename F::element>()
                      .size());
    for (auto& v : values) std::ranges::copy(value, v.begin());
  }
  auto const found = on_meshes({3}, 6, [&](int) {
    auto const s = measured<F>(law, h, values);
    return std::array{s.energy, s.p11, s.p22, s.p33, s.p12, s.p21};
  });
  char const* const names[] = {"W", "P11", "P22", "P33", "P12", "P21"};
  double const all[] = {expected.energy, expected.p11, expected.p22,
                        expected.p33,    expected.p12, expected.p21};
  for (std::size_t k = 0; k < 6; ++k)
    table.compare({"6, " + state + ", " + names[k], name_of<F>(), "distorted"}, found, k,
                  within(digits, all[k]));
}

Tensor<double, 3> gradient_of(int i, int k, double value) {
  auto h = Tensor<double, 3>::zero();
  h(i, k) = value;
  return h;
}

/// Both states of a law; `value` as its elements have it, if they do.
template <template <class> class L, Element E = Hex8>
void law(Table& table, L<double> const& law, State const& stretched, State const& sheared,
         double digits = 1e-11, std::vector<double> const& in_stretch = {},
         std::vector<double> const& in_shear = {}) {
  using F = Formulation<E, Full<E>, L>;
  compare<F>(table, "stretch 1.2", law, gradient_of(0, 0, stretch - 1), stretched, digits,
             in_stretch);
  compare<F>(table, "shear 0.4", law, gradient_of(0, 1, gradient), sheared, digits, in_shear);
}

/// W = f(Ī₁ − 3) + U(J), from f and f' where they are needed, and U with U'.
struct Isochoric {
  std::function<double(double)> f, slope;
  double volumetric, pressure;  // U and U' at J = stretch
};
State stretched(Isochoric const& w) {
  double const l = stretch, J = l, power = std::pow(J, -2.0 / 3), I1 = power * (l * l + 2);
  double const s = w.slope(I1 - 3);
  double const p11 = s * (2 * l * power - 2.0 / 3 * I1 / l) + w.pressure;
  double const p22 = s * (2 * power - 2.0 / 3 * I1) + w.pressure * J;
  return {w.f(I1 - 3) + w.volumetric, p11, p22, p22, 0, 0};
}
State sheared(Isochoric const& w) {
  double const g = gradient, s = w.slope(g * g), p = -2.0 / 3 * g * g * s;
  return {w.f(g * g), p, p, p, 2 * g * s, (2 * g + 2.0 / 3 * g * g * g) * s};
}

void printed_laws(Table& table) {
  Elastic const material{5.2, 0.3, 1};
  double const digits = 1e-11;
  law<Hooke>(table, Hooke<double>::from(material), {.14, 1.4, .6, .6, 0, 0},
             {.16, 0, 0, 0, .8, .8});
  law<SaintVenantKirchhoff>(table, SaintVenantKirchhoff<double>::from(material),
                            {.1694, 1.848, .66, .66, 0, 0}, {.1824, .56, .56, .24, 1.024, .8});
  law<NeoHookean>(table, NeoHookean<double>::from(material),
                  {.125218611520, 1.18913722532, .546964670382, .546964670382, 0, 0},
                  {.16, 0, 0, 0, .8, .8});
  law<IsochoricNeoHookean>(table, {mu, printed_bulk},
                           {.146287898323, 1.43293497263, .940239016422, .940239016422, 0, 0},
                           {.16, -.32 / 3, -.32 / 3, -.32 / 3, .8, 2.528 / 3});
  law<MooneyRivlin>(table, {.75, .25, printed_bulk},
                    {.145386713755, 1.42054749167, .947671504996, .947671504996, 0, 0},
                    {.16, -.4 / 3, -.4 / 3, -.16 / 3, .8, 2.56 / 3});
  law<Guccione>(table, {2, 8, 2, 4, 0}, {.472851032024, 6.22132275927, 0, 0, 0, 0},
                {.394868296911, .892715710023, .446357855012, 0, 2.41033241706, 2.23178927506},
                digits, {1, 0, 0}, {1, 0, 0});
}

void rubber(Table& table) {
  double const l = stretch;
  double const u = bulk / 2 * square(l - 1), du = bulk * (l - 1);
  auto const both = [&]<template <class> class L>(L<double> const& parameters, Isochoric const& w) {
    law<L>(table, parameters, stretched(w), sheared(w));
  };
  both(SimoNeoHookean<double>{mu, bulk},
       {[](double x) { return mu / 2 * x; }, [](double) { return mu / 2; },
        bulk / 4 * (l * l - 1 - 2 * std::log(l)), bulk / 2 * (l - 1 / l)});
  both(Yeoh<double>{1, 0.2, 0.1, bulk},
       {[](double x) { return x + 0.2 * x * x + 0.1 * x * x * x; },
        [](double x) { return 1 + 0.4 * x + 0.3 * x * x; }, u, du});
  both(Gent<double>{mu, 3, bulk}, {[](double x) { return -mu * 3 / 2 * std::log(1 - x / 3); },
                                   [](double x) { return mu / 2 / (1 - x / 3); }, u, du});
  double const a[] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
  double const locking = 1.5;
  both(ArrudaBoyce<double>{mu, locking, bulk},
       {[&](double x) {
          double sum = 0;
          for (int k = 1; k <= 5; ++k)
            sum += a[k - 1] / std::pow(locking, 2 * k - 2) * (std::pow(3 + x, k) - std::pow(3, k));
          return mu * sum;
        },
        [&](double x) {
          double sum = 0;
          for (int k = 1; k <= 5; ++k)
            sum += a[k - 1] / std::pow(locking, 2 * k - 2) * k * std::pow(3 + x, k - 1);
          return mu * sum;
        },
        u, du});
}

/// Σ μₚ/αₚ (λ̄₁^αₚ + λ̄₂^αₚ + λ̄₃^αₚ − 3) + κ/2 (J − 1)²
void ogden(Table& table) {
  Ogden<double> const law_{{1.5, 0.2, -0.4}, {1.3, 5, -2}, bulk};
  double const l = stretch, g = gradient;
  State s{bulk / 2 * square(l - 1), bulk * (l - 1), bulk * (l - 1) * l, 0, 0, 0};
  // In shear the stretches are q, 1/q, 1 along (q, 1), (−1, q) and e₃; P = τ F⁻ᵀ.
  double const q = g / 2 + std::sqrt(1 + g * g / 4);
  double energy = 0, t1 = 0, t2 = 0, t3 = 0;
  for (int p = 0; p < 3; ++p) {
    double const m = law_.mu[p], a = law_.alpha[p];
    double const along = std::pow(l, 2 * a / 3), across = std::pow(l, -a / 3);
    s.energy += m / a * (along + 2 * across - 3);
    s.p11 += m * 2 / 3 * (along - across) / l;
    s.p22 += m * (across - along) / 3;
    double const up = std::pow(q, a), down = 1 / up, mean = (up + down + 1) / 3;
    energy += m / a * (up + down - 2);
    t1 += m * (up - mean);
    t2 += m * (down - mean);
    t3 += m * (1 - mean);
  }
  s.p33 = s.p22;
  double const n = 1 + q * q;
  double const t11 = (t1 * q * q + t2) / n, t12 = (t1 - t2) * q / n, t22 = (t1 + t2 * q * q) / n;
  law<Ogden>(table, law_, s, {energy, t11 - g * t12, t22, t3, t12, t12 - g * t22});
}

void others(Table& table) {
  double const l = stretch, g = gradient, c = (lambda + mu) * (l - 1) - mu;
  law<StableNeoHookean>(table, {lambda, mu},
                        {mu / 2 * (l * l - 1) - mu * (l - 1) + (lambda + mu) / 2 * square(l - 1),
                         mu * l + c, mu + c * l, mu + c * l, 0, 0},
                        {mu / 2 * g * g, 0, 0, 0, mu * g, mu * g});

  // W = μ/(2b) (e^Q − 1), P = e^Q times that of Saint Venant-Kirchhoff, whose energy is μ Q/(2b).
  double const b = 1.5, in_stretch = std::exp(2 * b * .1694 / mu),
               in_shear = std::exp(2 * b * .1824 / mu);
  law<Fung>(table, {lambda, mu, b},
            {mu / (2 * b) * (in_stretch - 1), 1.848 * in_stretch, .66 * in_stretch,
             .66 * in_stretch, 0, 0},
            {mu / (2 * b) * (in_shear - 1), .56 * in_shear, .56 * in_shear, .24 * in_shear,
             1.024 * in_shear, .8 * in_shear});

  // P = 2μ (F − R) + λ tr(U − I) R; R turns by the angle whose cosine and sine are these.
  double const root = std::sqrt(4 + g * g), cosine = 2 / root, sine = g / root, t = root - 2;
  law<Corotated>(
      table, {lambda, mu}, {.14, 1.4, .6, .6, 0, 0},
      {mu * (2 * square(1 - cosine) + square(g - sine) + square(sine)) + lambda / 2 * t * t,
       2 * mu * (1 - cosine) + lambda * t * cosine, 2 * mu * (1 - cosine) + lambda * t * cosine,
       lambda * t, 2 * mu * (g - sine) + lambda * t * sine, 2 * mu * sine - lambda * t * sine});
}

/// A family along e₁ in the stretch, along e₂ in the shear: 2 F ∂W/∂C = 2 k F (d I + (1 − 3d) a ⊗ a) with
/// k = k₁ ε exp(k₂ ε²), upon a neo-Hookean matrix.
void arteries(Table& table) {
  double const k1 = 1, k2 = 0.5, d = 0.1, l = stretch, g = gradient;
  Isochoric const matrix{[](double x) { return mu / 2 * x; }, [](double) { return mu / 2; },
                         bulk / 2 * square(l - 1), bulk * (l - 1)};
  State s = stretched(matrix), t = sheared(matrix);
  double strain = (1 - 2 * d) * (l * l - 1), k = 2 * k1 * strain * std::exp(k2 * strain * strain);
  s.energy += k1 / (2 * k2) * (std::exp(k2 * strain * strain) - 1);
  s.p11 += k * l * (1 - 2 * d);
  s.p22 += k * d;
  s.p33 += k * d;
  strain = (1 - 2 * d) * g * g;
  k = 2 * k1 * strain * std::exp(k2 * strain * strain);
  t.energy += k1 / (2 * k2) * (std::exp(k2 * strain * strain) - 1);
  t.p11 += k * d;
  t.p22 += k * (1 - 2 * d);
  t.p33 += k * d;
  t.p12 += k * g * (1 - 2 * d);
  law<HolzapfelGasserOgden>(table, {mu, k1, k2, d, bulk}, s, t, 1e-11, {1, 0, 0, 0, 0, 0},
                            {0, 1, 0, 0, 0, 0});
}

/// An element with one corner pushed through it: an energy for laws that take inversion, none for the others.
void pushed_through(Table& table) {
  auto const row = [&]<template <class> class L>(L<double> const& parameters) {
    using F = Formulation<Tet4, Gauss<1>, L>;
    Mesh<Tet4> mesh;
    mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.elements<Tet4>() = {{0, 1, 2, 3}};
    Body body{Reference<double>{}, mesh, Elastic{1, 0, 1}, Group<F>{parameters}};
    std::vector<Point<3>> u(4);
    u[3] = {0, 0, -1.5};
    body.set_displacements(u);
    double const finite = std::isfinite(strain_energy(body)) ? 1 : 0;
    table.compare({"6, a corner pushed through, W is finite", name_of<F>(), "one element"}, finite,
                  takes_inversion<F> ? Printed{1, 0, "1"} : Printed{0, 0, "0"});
  };
  row(Hooke<double>{lambda, mu});
  row(SaintVenantKirchhoff<double>{lambda, mu});
  row(StableNeoHookean<double>{lambda, mu});
  row(Corotated<double>{lambda, mu});
  row(Fung<double>{lambda, mu, 1});
  row(NeoHookean<double>{lambda, mu});
  row(IsochoricNeoHookean<double>{mu, bulk});
  row(SimoNeoHookean<double>{mu, bulk});
  row(MooneyRivlin<double>{0.75, 0.25, bulk});
  row(Yeoh<double>{1, 0.2, 0.1, bulk});
  row(Gent<double>{mu, 97.2, bulk});
  row(ArrudaBoyce<double>{mu, 7, bulk});
  row(Ogden<double>{{1.5, 0.2, -0.4}, {1.3, 5, -2}, bulk});
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  using namespace pliant::verification;
  Table table("Uniform stretch and shear of every law (6)", argc, argv);
  printed_laws(table);
  rubber(table);
  ogden(table);
  others(table);
  arteries(table);
  pushed_through(table);
  return table.finish();
}
#endif
