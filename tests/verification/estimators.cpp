#include "verification/support/effectivity.hpp"
#include "verification/support/l_shape.hpp"
#include "verification/support/manufactured.hpp"

// Effectivity of RecoveredStress: the energy norm of the error that it estimates over the true one, on problems
// with a known answer. Numbers of sections are those of REFERENCES.
namespace pliant::verification {

/// Section 9: the gradient of the field is known.
template <Element E, template <class> class L, class Q = Full<E>>
void manufactured_problem(EffectivityTable& table, std::vector<int> const& sizes, Grid grid) {
  using F = Formulation<E, Q, L>;
  for (int n : sizes) {
    auto const mesh = unit_grid<E>(n, grid);
    auto const law = L<double>{manufactured_lambda, manufactured_mu};
    auto body = body_of<F>(mesh, law);
    auto exact = mesh.nodes;
    for (auto& p : exact) {
      auto const u = exact_at<E::dim>(p).u;
      for (std::size_t k = 0; k < E::dim; ++k) p[k] = u[static_cast<int>(k)];
    }
    body.set_displacements(exact);
    body.clamp(mesh::outer_sides(mesh));
    body.set_loads(
        body_loads(mesh, [](Point<E::dim> const& X) { return force_needed<L, E::dim>(X); }));
    solve_static(body);
    double const error = energy_of_error<E>(
        body, [&](Point<E::dim> const&) { return law; },
        [](Point<E::dim> const& X) { return exact_at<E::dim>(X).gradient; });
    std::string const name = E::dim == 2 ? "9, manufactured, plane" : "9, manufactured, solid";
    table.row(name + (grid == Grid::curved ? ", curved" : ""), name_of<F>(), body, error);
  }
}

template <template <class> class L>
void plane_problems(EffectivityTable& table) {
  int const finer = table.full() ? 2 : 1;
  for (Grid grid : {Grid::straight, Grid::curved}) {
    manufactured_problem<Tri3, L>(table, {8, 16 * finer}, grid);
    manufactured_problem<Quad4, L>(table, {8, 16 * finer}, grid);
    manufactured_problem<Tri6, L>(table, {4, 8 * finer}, grid);
    manufactured_problem<Quad8, L>(table, {4, 8 * finer}, grid);
    manufactured_problem<Quad9, L>(table, {4, 8 * finer}, grid);
  }
  manufactured_problem<Quad4, L, OnePoint>(table, {8, 16 * finer}, Grid::straight);
}
template <template <class> class L>
void solid_problems(EffectivityTable& table) {
  int const finer = table.full() ? 2 : 1;
  for (Grid grid : {Grid::straight, Grid::curved}) {
    manufactured_problem<Tet4, L>(table, {4 * finer}, grid);
    manufactured_problem<Hex8, L>(table, {4 * finer}, grid);
    manufactured_problem<Tet10, L>(table, {2 * finer}, grid);
  }
  if constexpr (has_full_form) {
    if (!table.full()) return;
    manufactured_problem<Wedge6, L>(table, {8}, Grid::straight);
    manufactured_problem<Pyramid5, L>(table, {8}, Grid::straight);
    manufactured_problem<Hex20, L>(table, {4}, Grid::straight);
    manufactured_problem<Hex27, L>(table, {4}, Grid::straight);
  }
}

/// Sets the exact displacements of section 8 on the outer sides, and solves.
template <class TheBody>
void solve_l_shape(TheBody& body) {
  std::vector<Point<2>> u;
  for (auto const& p : body.mesh().nodes) u.push_back(displacement_in_l_shape(p));
  body.set_displacements(u);
  auto const handle = body.clamp(mesh::outer_sides_where(body.mesh(), on_outer_l_shape));
  solve_static(body, where_forces_cancel);
  body.release(handle);
}
/// On uniform meshes, and where the estimate itself refines.
template <Element E>
void l_shapes(EffectivityTable& table, int n) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto body = body_of<F>(l_shape<E>(n, 1), l_shape_material);
  auto const row = [&](char const* meshes) {
    double const error = energy_of_error<E>(
        body, [](Point<2> const&) { return Hooke<double>::from(l_shape_material); },
        gradient_in_l_shape);
    table.row(std::string("8, L-shape, ") + meshes, name_of<F>(), body, error);
  };
  solve_l_shape(body);
  row("uniform");
  if constexpr (E::degree == 1) {
    for (int round = table.full() ? 10 : 5; round > 0; --round) {
      Adaptation{when<F>(RecoveredStress{}).bulk(0.5).refine()}.now(body);
      solve_l_shape(body);
    }
    row("refined by bulk(0.5)");
  }
}

/// Two materials, by two groups, along a bar of ν = 0: σ = 1 + sin πx is smooth, the strain jumps at x = 1/2.
void bars(EffectivityTable& table, std::vector<int> const& sizes) {
  using Soft = Formulation<Quad4, Gauss<2>, Hooke>;
  using Stiff = Formulation<Quad4, Gauss<3>, Hooke>;
  Hooke<double> const soft{0, 0.5}, stiff{0, 10};  // E = 1 and 20
  double const pi = std::numbers::pi;
  auto const is_soft = [](Point<2> const& X) { return X[0] < 0.5; };
  for (int n : sizes) {
    auto const mesh = mesh::rectangle<Quad4>({.size = {1, 0.25}, .cells = {n, n / 4}});
    Body body{Reference<double>{}, mesh, Elastic{1, 0, 1}, Group<Soft>{soft}, Group<Stiff>{stiff}};
    std::vector<Index> right;
    auto const& elements = mesh.elements<Quad4>();
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (mesh.nodes[static_cast<std::size_t>(elements[e][0])][0] > 0.5 - 1e-9)
        right.push_back(static_cast<Index>(e));
    body.assign<Stiff>(right);
    auto u = mesh.nodes;
    auto const work = [&](double x) { return x + (1 - std::cos(pi * x)) / pi; };
    for (auto& p : u) p = {p[0] < 0.5 ? work(p[0]) : work(0.5) + (work(p[0]) - work(0.5)) / 20, 0};
    body.set_displacements(u);
    body.clamp(mesh.boundary("left"));
    body.clamp(mesh.boundary("right"));
    body.set_loads(body_loads(mesh, [&](Point<2> const& X) {
      return Point<2>{-pi * std::cos(pi * X[0]), 0};
    }));
    solve_static(body);
    double const error = energy_of_error<Quad4>(
        body, [&](Point<2> const& X) { return is_soft(X) ? soft : stiff; },
        [&](Point<2> const& X) {
          auto h = Tensor<double, 2>::zero();
          h(0, 0) = (1 + std::sin(pi * X[0])) / (is_soft(X) ? 1 : 20);
          return h;
        });
    table.row("bar of two materials", name_of<Soft>() + " and " + name_of<Stiff>(), body, error);
  }
}

/// A body under dead loads in equilibrium: what it is, and its potential energy.
template <class F, class M, class Loads>
auto loaded(M const& mesh, LawOf<F> const& law, Loads const& loads, NewtonOptions const& newton,
            double& energy) {
  auto body = body_of<F>(mesh, law);
  body.clamp(mesh.boundary("left"));
  auto const forces = loads(mesh);
  body.set_loads(forces);
  solve_static(body, newton);
  energy = potential(body, forces);
  return body;
}

/// Under dead loads the error is what the potential energy has more than the least, which is that of a fine mesh.
template <class Problem>
class LoadedRows {
 public:
  template <class Fine>
  void find_least(LawOf<Fine> const& law, int n) {
    loaded<Fine>(Problem::mesh(typename Fine::element{}, n, Problem::power), law, Problem::loads(),
                 Problem::newton(), least_);
  }
  template <class F>
  void rows(EffectivityTable& table, LawOf<F> const& law, std::vector<int> const& sizes,
            double lowest = EffectivityTable::least) const {
    rows_of<F>(table, law, sizes, lowest, 1, Problem::name);
  }
  /// On meshes that are finer towards singular corners.
  template <class F>
  void graded_rows(EffectivityTable& table, LawOf<F> const& law,
                   std::vector<int> const& sizes) const {
    rows_of<F>(table, law, sizes, EffectivityTable::least, 2,
               std::string(Problem::name) + ", graded");
  }

 private:
  template <class F>
  void rows_of(EffectivityTable& table, LawOf<F> const& law, std::vector<int> const& sizes,
               double lowest, double power, std::string const& name) const {
    for (int n : sizes) {
      double energy = 0;
      auto const body = loaded<F>(Problem::mesh(typename F::element{}, n, power), law,
                                  Problem::loads(), Problem::newton(), energy);
      table.row(name, name_of<F>(), body, energy - least_, lowest);
    }
  }
  double least_ = 0;
};

/// Section 10: the cantilever of 10 to 1 under its weight, at large rotations.
struct Cantilever {
  static constexpr char const* name = "10, cantilever under its weight";
  static constexpr double power = 1.5;
  static constexpr NewtonOptions newton() { return {.load_steps = 3, .tolerance = 1e-7}; }
  static auto loads() {
    return [](auto const& mesh) { return body_loads(mesh, Point<2>{0, -1e4}); };
  }
  template <Element E>
  static Mesh<E> mesh(E, int n, double exponent) {
    auto mesh = graded<E>({n, n / 4}, towards_start(exponent), towards_ends(exponent));
    for (auto& p : mesh.nodes) p[1] = 0.1 * p[1] - 0.05;
    return mesh;
  }
};
template <template <class> class L>
void cantilevers(EffectivityTable& table) {
  auto const law = L<double>::from(Elastic{2e6, 0.3, 1000});
  LoadedRows<Cantilever> problem;
  problem.find_least<Formulation<Quad9, Gauss<3>, L>>(law, table.full() ? 64 : 32);
  std::vector<int> const linear = table.full() ? std::vector{16, 32} : std::vector{16};
  std::vector<int> const quadratic = table.full() ? std::vector{8, 16} : std::vector{8};
  problem.rows<Formulation<Quad4, Gauss<2>, L>>(table, law, linear);
  problem.rows<Formulation<Tri3, Gauss<1>, L>>(table, law, linear);
  problem.rows<Formulation<Quad8, Gauss<3>, L>>(table, law, quadratic);
  problem.rows<Formulation<Tri6, Gauss<2>, L>>(table, law, quadratic);
}

/// Section 3: Cook's membrane.
struct Membrane {
  static constexpr char const* name = "3, Cook's membrane";
  static constexpr double power = 2;
  static constexpr NewtonOptions newton() { return {.load_steps = 2, .tolerance = 1e-6}; }
  static auto loads() {
    return [](auto const& mesh) {
      Point<2> const up{0, 1.0 / 16};
      return traction_loads(mesh, mesh.boundary("right"), up);
    };
  }
  template <Element E>
  static Mesh<E> mesh(E, int n, double exponent) {
    auto mesh = graded<E>({n, n}, towards_ends(exponent), towards_ends(exponent));
    for (auto& p : mesh.nodes) p = {48 * p[0], 44 * (p[0] + p[1]) - 28 * p[0] * p[1]};
    return mesh;
  }
};
void membranes(EffectivityTable& table) {
  int const n = table.full() ? 32 : 16, fine = table.full() ? 48 : 24;
  {
    using Fine = Formulation<Quad9, Gauss<3>, PlaneStress<Hooke>::law>;
    auto const law = LawOf<Fine>::from({1, 1.0 / 3, 1});
    LoadedRows<Membrane> sheet;
    sheet.find_least<Fine>(law, fine);
    sheet.rows<Formulation<Quad4, Gauss<2>, PlaneStress<Hooke>::law>>(table, law, {8, n});
    sheet.rows<Formulation<Tri3, Gauss<1>, PlaneStress<Hooke>::law>>(table, law, {8, n});
    sheet.rows<Formulation<Quad9, Gauss<3>, PlaneStress<Hooke>::law>>(table, law, {n / 2});
  }
  {
    LoadedRows<Membrane> rubber;
    auto const law = NeoHookean<double>::from({.4225 * 2.6, .3, 1});
    rubber.find_least<Formulation<Quad9, Gauss<3>, NeoHookean>>(law, fine);
    rubber.rows<Formulation<Quad4, Gauss<2>, NeoHookean>>(table, law, {8, n});
    // Few triangles at a singular corner carry the error of a uniform mesh, and have few neighbours.
    rubber.rows<Formulation<Tri6, Gauss<2>, NeoHookean>>(table, law, {n / 2}, 0.4);
    rubber.graded_rows<Formulation<Tri6, Gauss<2>, NeoHookean>>(table, law, {n / 2});
  }
  {
    LoadedRows<Membrane> almost_incompressible;
    auto const law = Hooke<double>::from({2.40565, .4999, 1});
    almost_incompressible.find_least<Formulation<Quad9, FBar<Gauss<3>>, Hooke>>(law, fine);
    almost_incompressible.rows<Formulation<Quad4, FBar<Gauss<2>>, Hooke>>(table, law, {8, n});
  }
}

/// Section 3: the slab of Cook's shape with free faces.
struct Slab {
  static constexpr char const* name = "3, slab of Cook's shape, free faces";
  static constexpr double power = 2;
  static constexpr NewtonOptions newton() { return {.load_steps = 2, .tolerance = 1e-6}; }
  static auto loads() {
    return [](auto const& mesh) {
      Point<3> const up{0, 1.0 / 16, 0};
      return traction_loads(mesh, mesh.boundary("right"), up);
    };
  }
  template <Element E>
  static Mesh<E> mesh(E, int n, double exponent) {
    auto mesh = graded<E>({n, n, 1}, towards_ends(exponent), towards_ends(exponent), evenly);
    for (auto& p : mesh.nodes) p = {48 * p[0], 44 * (p[0] + p[1]) - 28 * p[0] * p[1], p[2]};
    return mesh;
  }
};
void slabs(EffectivityTable& table) {
  double const mu = .4225, lambda = 1.5 * mu;
  SimoNeoHookean<double> const law{mu, lambda + 2 * mu / 3};
  LoadedRows<Slab> slab;
  slab.find_least<Formulation<Hex27, Gauss<3>, SimoNeoHookean>>(law, table.full() ? 16 : 10);
  slab.rows<Formulation<Hex8, Gauss<2>, SimoNeoHookean>>(table, law, {8, table.full() ? 16 : 12});
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::verification;
  EffectivityTable table(argc, argv);
  plane_problems<SaintVenantKirchhoff>(table);
  solid_problems<SaintVenantKirchhoff>(table);
  bars(table, {16, 64});
  l_shapes<Tri3>(table, 16);
  l_shapes<Quad4>(table, 16);
  l_shapes<Tri6>(table, 12);
  l_shapes<Quad9>(table, 12);
  cantilevers<SaintVenantKirchhoff>(table);
  if constexpr (has_full_form)
    if (table.full()) cantilevers<NeoHookean>(table);
  membranes(table);
  slabs(table);
  return table.finish();
}
