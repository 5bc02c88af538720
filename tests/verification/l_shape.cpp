#include "verification/support/l_shape.hpp"

// REFERENCES, section 8: the L-shape of linear elasticity, whose exact solution is singular at the
// re-entrant corner (Alberty, Carstensen, Funken and Klose 2002). Rates in the energy norm: alpha on
// uniform meshes, whatever the element; the element's degree on meshes graded well enough.
namespace pliant::verification {

/// The energy norm of the error, and the strain energy.
template <Element E>
Runs solved(std::vector<int> const& sizes, double power) {
  using F = Formulation<E, Full<E>, Hooke>;
  return on_meshes(sizes, 2, [&](int n) {
    auto const mesh = l_shape<E>(n, power);
    auto body = body_of<F>(mesh, l_shape_material);
    std::vector<Point<2>> u;
    for (auto const& p : mesh.nodes) u.push_back(displacement_in_l_shape(p));
    body.set_displacements(u);
    body.clamp(mesh::outer_sides_where(mesh, on_outer_l_shape));
    auto const report = solve_static(body, where_forces_cancel);
    return std::array{error_in_l_shape<E>(body), report.energy};
  });
}

template <Element E>
void rows(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto const uniform = solved<E>(sizes, 1);
  table.converge({"8, L-shape, energy norm", name_of<F>(), "uniform, 3 n x n"}, uniform, 0, alpha);
  auto const well_graded = solved<E>(sizes, E::degree == 1 ? 2.5 : 4.5);
  table.converge({"8, L-shape, energy norm", name_of<F>(), "graded, 3 n x n"}, well_graded, 0,
                 E::degree);
  table.approach({"8, L-shape, energy", name_of<F>(), "graded, 3 n x n"}, well_graded, 1,
                 within(1e-8, 2.054512443695e-4), 2 * E::degree);
  if (E::degree > 1)
    table.compare({"8, L-shape, energy", name_of<F>(), "graded, 3 n x n"}, well_graded, 1,
                  within(1e-9, 2.054512443695e-4));
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  verification::Table table("L-shape (8)", argc, argv);
  verification::rows<Tri3>(table, {16, 32, 64});
  verification::rows<Quad4>(table, {16, 32, 64});
  verification::rows<Tri6>(table, {12, 24, 48});
  verification::rows<Quad8>(table, {12, 24, 48});
  verification::rows<Quad9>(table, {12, 24, 48});
  return table.finish();
}
