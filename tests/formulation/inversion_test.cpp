#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#include <pliant/solver/newton.hpp>

#include "support/elements.hpp"
#include "support/inverted_states.hpp"

// Elements one of whose nodes was pushed through them.
namespace pliant::test::inversion_test {

/// λ = 3 Pa, μ = 2 Pa: stiffened as the other suites have it.
template <class L>
L const sample = L::from({.young = 5.2, .poisson = 0.3, .density = 1});

/// The displacements of an element whose last corner is moved to its image in the middle of the others,
/// `depth` times as far away.
template <Element E>
Nodal<E, double> pushed_through(Nodal<E, double> const& rest, double depth) {
  constexpr int last = E::nodes - 1;
  auto u = Nodal<E, double>::zero();
  for (int k = 0; k < E::dim; ++k) {
    double middle = 0;
    for (int a = 0; a < last; ++a) middle += rest(a, k) / last;
    u(last, k) = (1 + depth) * (middle - rest(last, k));
  }
  return u;
}
template <Element E>
Nodal<E, double> at_rest() {
  Nodal<E, double> rest;
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) rest(a, k) = E::place(a)[k];
  return rest;
}

/// Energy, forces and tangent of the element are finite if the formulation takes inversion; if not, none
/// of the three is.
template <class F, class L>
void check_pushed(L const& parameters) {
  using E = typename F::element;
  constexpr bool finite = takes_inversion<F>;
  auto const law = prepared<F>(parameters);
  auto const rest = at_rest<E>();
  for (double depth : {1.5, 2.0, 4.0}) {
    INFO(E::name() << ", " << F::points << " points, depth " << depth);
    auto const u = pushed_through<E>(rest, depth);
    auto const f = force<F>(law, rest, u), df = tangent_product<F>(law, rest, u, u);
    CHECK(std::isfinite(energy<F>(law, rest, u)) == finite);
    int count = 0, changes = 0;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) {
        count += count_finite(f(a, k));
        changes += count_finite(df(a, k));
      }
    CHECK((count == E::nodes * E::dim) == finite);
    CHECK((changes == E::nodes * E::dim) == finite);
  }
}

/// On every scheme; F-bar has its own limits where a law takes inversion.
template <template <class> class L>
void check_law(L<double> const& law) {
  check_pushed<Formulation<Tet4, Gauss<1>, L>>(law);
  check_pushed<Formulation<Quad4, Gauss<2>, L>>(law);
  check_pushed<Formulation<Quad4, OnePoint, L>>(law);
  using Mean = Formulation<Quad4, FBar<Gauss<2>>, L>;
  if constexpr (takes_inversion<Mean> == takes_inversion<L<double>>) check_pushed<Mean>(law);
}

TEMPLATE_TEST_CASE("an element with a node pushed through it is refused by laws for J > 0",
                   "[formulation]", NeoHookean<double>, IsochoricNeoHookean<double>,
                   SimoNeoHookean<double>, MooneyRivlin<double>, Yeoh<double>, Gent<double>,
                   ArrudaBoyce<double>, Ogden<double>) {
  static_assert(!takes_inversion<TestType>);
  check_law(sample<TestType>);
}

TEMPLATE_TEST_CASE("an element with a node pushed through it is taken by the other laws",
                   "[formulation]", Hooke<double>, SaintVenantKirchhoff<double>,
                   StableNeoHookean<double>, Corotated<double>, Fung<double>) {
  static_assert(takes_inversion<TestType>);
  check_law(sample<TestType>);
}

TEST_CASE("F-bar takes no element that is inverted in part", "[formulation]") {
  using F = Formulation<Quad4, FBar<Gauss<2>>, StableNeoHookean>;
  static_assert(!takes_inversion<F>);
  static_assert(takes_inversion<Formulation<Quad4, FBar<Gauss<2>>, Hooke>>);
  auto const rest = at_rest<Quad4>();
  auto const w = [&](double depth) {
    return energy<F>(sample<StableNeoHookean<double>>, rest, pushed_through<Quad4>(rest, depth));
  };
  CHECK(std::isfinite(w(-0.5)));
  CHECK_FALSE(std::isfinite(w(1.5)));
}

TEST_CASE("no static solution is found with a node pushed through its element", "[formulation]") {
  Mesh<Tet4> mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.elements<Tet4>() = {{0, 1, 2, 3}};
  Body body{Reference<double>{},
            mesh,
            {.young = 5.2, .poisson = 0.3, .density = 1},
            Group<Formulation<Tet4, Gauss<1>, Yeoh>>{}};
  body.clamp(std::vector<Index>{0, 1, 2});
  std::vector<Point<3>> u(4, Point<3>{});
  u[3] = {0, 0, -1.5};
  body.set_displacements(u);
  CHECK_FALSE(std::isfinite(strain_energy(body)));
  CHECK_THROWS_AS(solve_static(body), Error);
  CHECK(body.displacements()[3][2] == -1.5);
}

}  // namespace pliant::test::inversion_test
