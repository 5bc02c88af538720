#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 3: Cook's membrane, every row, and deal.II's table of a slab with free faces.
namespace pliant::verification {

/// Corners (0, 0), (48, 44), (48, 60), (0, 44), from the unit square.
template <std::size_t Dim>
void shape(std::vector<std::array<double, Dim>>& nodes) {
  for (auto& p : nodes) {
    double const s = p[0], t = p[1];
    p[0] = 48 * s;
    p[1] = 44 * (s + t) - 28 * s * t;
  }
}

struct Results {
  Printed uy_middle, uy_corner, ux_middle;
};

template <class F>
Runs bent(LawOf<F> const& law, double force, std::vector<int> const& sizes, double power,
          NewtonOptions const& newton = where_forces_cancel) {
  using E = typename F::element;
  return on_meshes(sizes, 3, [&](int n) {
    auto mesh = graded<E>({n, n}, towards_ends(power), towards_ends(power));
    shape(mesh.nodes);
    auto body = body_of<F>(mesh, law);
    body.clamp(mesh.boundary("left"));
    body.set_loads(traction_loads(mesh, mesh.boundary("right"), Point<2>{0, force / 16}));
    solve_static(body, newton);
    auto const u = body.displacements();
    auto const middle = u[node_at(mesh, {48, 52})], corner = u[node_at(mesh, {48, 60})];
    return std::array{middle[1], corner[1], middle[0]};
  });
}

template <class F>
Labels labels(std::string const& variant, char const* what) {
  return {"3, " + variant + ", " + what, name_of<F>(), "graded n x n"};
}
template <class F>
void compare(Table& table, std::string const& variant, Runs const& runs, Results const& expected) {
  table.compare(labels<F>(variant, "uy(A)"), runs, 0, expected.uy_middle);
  table.compare(labels<F>(variant, "uy(C)"), runs, 1, expected.uy_corner);
  table.compare(labels<F>(variant, "ux(A)"), runs, 2, expected.ux_middle);
}

Elastic const material{1, 1.0 / 3, 1};

template <Element E, class Q>
void sheet(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Q, PlaneStress<Hooke>::law>;
  compare<F>(table, "plane stress", bent<F>(LawOf<F>::from(material), 1, sizes, 3),
             {printed("23.9677"), printed("25.189"), printed("-10.6953")});
}

void small_strain(Table& table) {
  sheet<Quad9, Gauss<3>>(table, {12, 24, 48});
  if constexpr (has_full_form)
    if (table.full()) sheet<Tri6, Gauss<2>>(table, {16, 32, 64});
  using Thick = Formulation<Quad9, Gauss<3>, Hooke>;
  compare<Thick>(table, "plane strain",
                 bent<Thick>(Hooke<double>::from(material), 1, {12, 24, 48}, 3),
                 {printed("21.5245"), printed("22.610"), printed("-9.5801")});
}

/// One point per element, and stiffness against the hourglasses that it does not see.
void one_point(Table& table) {
  using F = Formulation<Quad4, OnePoint, Hooke>;
  auto const runs = bent<F>(Hooke<double>::from(material), 1, {16, 32, 64}, 3);
  table.approach(labels<F>("plane strain", "uy(A)"), runs, 0, printed("21.5245"), 2);
  table.approach(labels<F>("plane strain", "uy(C)"), runs, 1, printed("22.610"), 2);
  table.approach(labels<F>("plane strain", "ux(A)"), runs, 2, printed("-9.5801"), 2);
}

/// Displacements alone lock; with the mean dilatation of its elements, a body does not.
template <class F>
Runs almost_incompressible(std::vector<int> const& sizes) {
  return bent<F>(Hooke<double>::from({240.565, .4999, 1}), 100, sizes, 3, {.tolerance = 1e-5});
}
Results const incompressible{printed("7.695"), printed("8.076"), printed("-3.3933")};

/// Where the pressure is linear in the elements.
template <Element E>
void meets_incompressible(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, FBar<Gauss<3>>, Hooke>;
  compare<F>(table, "nu = .4999", almost_incompressible<F>(sizes), incompressible);
}
/// Where it is constant in each of them, errors fall as h². (The order needs all digits of the reference.)
template <Element E>
void approaches_incompressible(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, FBar<Gauss<E::degree + 1>>, Hooke>;
  auto const runs = almost_incompressible<F>(sizes);
  table.approach(labels<F>("nu = .4999", "uy(A)"), runs, 0, printed("7.69524"), 2);
  table.approach(labels<F>("nu = .4999", "uy(C)"), runs, 1, incompressible.uy_corner, 2);
  table.approach(labels<F>("nu = .4999", "ux(A)"), runs, 2, incompressible.ux_middle, 2);
}

double const mu = .4225, lambda = 2 * mu * .3 / (1 - 2 * .3), bulk = lambda + 2 * mu / 3;

/// The smallest element at the upper corner of the clamp, where the strain is singular, may fold between points.
template <template <class> class L>
void finite_strain(Table& table, std::string const& variant, L<double> const& law,
                   Results const& expected) {
  using F = Formulation<Quad9, Gauss<3>, L>;
  compare<F>(
      table, variant,
      bent<F>(law, 1, {12, 24, 48}, 2, {.load_steps = 4, .tolerance = 1e-8, .accept_folded = true}),
      expected);
}

void plane(Table& table) {
  small_strain(table);
  one_point(table);
  if constexpr (has_full_form)
    if (table.full()) meets_incompressible<Quad8>(table, {12, 24, 48});
  meets_incompressible<Quad9>(table, {12, 24, 48});
  approaches_incompressible<Quad4>(table, {16, 32, 64});
  if constexpr (has_full_form)
    if (table.full()) approaches_incompressible<Tri6>(table, {24, 48, 96});
  finite_strain<NeoHookean>(table, "NH-ln", {lambda, mu},
                            {printed("14.523"), printed("13.594"), printed("-9.106")});
  if constexpr (has_full_form) {
    if (!table.full()) return;
    // The reference's own meshes lie 4e-3 and 2e-3 apart.
    finite_strain<SimoNeoHookean>(
        table, "NH-simo", {mu, bulk},
        {printed("14.742(4)"), printed("13.773(4)"), printed("-9.194(4)")});
    finite_strain<IsochoricNeoHookean>(
        table, "NH-iso", {mu, bulk},
        {printed("14.732(2)"), printed("13.765(2)"), printed("-9.215(2)")});
  }
}

/// deal.II's code gallery, "Quasi-static finite-strain compressible elasticity": point C of a slab 1 mm
/// thick, uniform n x n x 1.
template <class F>
void slab(Table& table, LawOf<F> const& law, std::vector<std::pair<int, char const*>> const& rows) {
  using E = typename F::element;
  for (auto const& [n, expected] : rows) {
    auto const runs = on_meshes({n}, 1, [&](int cells) {
      auto mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {cells, cells, 1}});
      shape(mesh.nodes);
      auto body = body_of<F>(mesh, law);
      body.clamp(mesh.boundary("left"));
      body.set_loads(traction_loads(mesh, mesh.boundary("right"), Point<3>{0, 1.0 / 16, 0}));
      solve_static(body, where_forces_cancel);
      return std::array{body.displacements()[node_at(mesh, {48, 60, 0})][1]};
    });
    table.compare({"3, slab of deal.II, uy(C)", name_of<F>(), "n x n x 1"}, runs, 0,
                  printed(expected));
  }
}

void slabs(Table& table) {
  std::vector<std::pair<int, char const*>> linear{{1, "5.15"},  {2, "8.72"},   {4, "12.02"},
                                                  {8, "13.61"}, {16, "14.13"}, {32, "14.28"}};
  std::vector<std::pair<int, char const*>> quadratic{
      {1, "12.19"}, {2, "13.83"}, {4, "14.22"}, {8, "14.30"}, {16, "14.32"}};
  if (table.full()) {
    linear.emplace_back(64, "14.32");
    quadratic.emplace_back(32, "14.33");
  }
  slab<Formulation<Hex8, Gauss<2>, SimoNeoHookean>>(table, {mu, bulk}, linear);
  slab<Formulation<Hex27, Gauss<3>, SimoNeoHookean>>(table, {mu, bulk}, quadratic);
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  using namespace pliant::verification;
  Table table("Cook's membrane (3)", argc, argv);
  plane(table);
  slabs(table);
  return table.finish();
}
#endif
