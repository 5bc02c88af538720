#include <pliant/adaptation/adaptation.hpp>
#include <pliant/adaptation/estimator/recovered_stress.hpp>
#include <pliant/mesh/with_types.hpp>
#include <pliant/solve.hpp>

#include "verification/support/form.hpp"
#include "verification/support/l_shape.hpp"

// REFERENCES, section 8: the L-shape of linear elasticity, and the same extruded under plane strain, refined where
// RecoveredStress says. In the plane the energy norm of the error falls with N^(-p/2) over the number N of
// unknowns, p the elements' degree, as if the solution were smooth; on uniform meshes with N^(-alpha/2). Along
// an edge, cells that are refined alike in all directions allow N^(-1/3) to p = 1, and N^(-alpha) to p = 2, in
// the end; with so many unknowns as here it has to be faster than uniform meshes' N^(-alpha/3).
namespace pliant::verification::refined_l_shape {

/// The L-shape with one layer of cells for each along an arm.
template <Element E>
Mesh<E> initial_mesh(int n) {
  if constexpr (E::dim == 2) {
    return l_shape<E>(n, 1);
  } else {
    auto const plane = l_shape<Quad4>(n, 1);
    auto const count = static_cast<Index>(plane.nodes.size());
    using Linear = LinearOn<E>;
    Mesh<Linear> solid;
    for (int k = 0; k <= n; ++k)
      for (auto const& p : plane.nodes) solid.nodes.push_back({p[0], p[1], std::sqrt(2.0) * k / n});
    for (int k = 0; k < n; ++k)
      for (auto const& q : plane.elements<Quad4>()) {
        Connectivity<Hex8> hex;
        for (std::size_t a = 0; a < 4; ++a) {
          hex[a] = q[a] + k * count;
          hex[a + 4] = hex[a] + count;
        }
        auto& elements = solid.template elements<Linear>();
        if constexpr (std::same_as<Linear, Hex8>)
          elements.push_back(hex);
        else
          for (auto const& part : mesh::detail::split_cell(hex, typename Linear::cell{}))
            elements.push_back(part);
      }
    if constexpr (E::degree > 1)
      return mesh::raised<E>(solid);
    else
      return solid;
  }
}

template <int Dim>
bool on_outer(Point<Dim> const& p) {
  return on_outer_l_shape({p[0], p[1]});
}

/// Rounds of adaptation until there are so many unknowns: of each round, how many there were, and the error of the
/// elements Es.
template <Element... Es, class TheBody, class Adapt>
Runs adapted(TheBody& body, long most, Adapt&& adapt) {
  constexpr int dim = TheBody::dim;
  body.clamp(mesh::outer_sides_where(body.mesh(), on_outer<dim>));
  if constexpr (dim == 3)
    body.hold(
        mesh::outer_sides_where(
            body.mesh(), [](Point<3> const& p) { return p[2] == 0 || p[2] == std::sqrt(2.0); }),
        4);
  Runs runs;
  for (;;) {
    auto u = body.displacements();
    for (std::size_t i = 0; i < u.size(); ++i) {
      auto const& p = body.mesh().nodes[i];
      if (!on_outer<dim>(p)) continue;
      auto const exact = displacement_in_l_shape({p[0], p[1]});
      for (std::size_t k = 0; k < 2; ++k) u[i][k] = exact[k];
    }
    body.set_displacements(u);
    auto const report = solve_static(body, where_forces_cancel);
    double const squares = (square(error_in_l_shape<Es>(body)) + ...);
    runs.push_back({static_cast<int>(report.unknowns), {std::sqrt(squares)}});
    if (report.unknowns > most) return runs;
    adapt.now(body);
  }
}

/// Refined where the estimate says.
template <Element E>
Runs refined(int n, long most, double share) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto body = body_of<F>(initial_mesh<E>(n), l_shape_material);
  return adapted<E>(body, most, Adaptation{when<F>(RecoveredStress{}).bulk(share).refine()});
}

/// Linear elements are raised where the estimate says, with their neighbours, and then refined.
template <Element E, Element Quadratic>
Runs raised_and_refined(int n, long most, double share) {
  using Low = Formulation<E, Full<E>, Hooke>;
  using High = Formulation<Quadratic, Full<Quadratic>, Hooke>;
  Body body(Reference<double>{}, mesh::with_types<E, Quadratic>(initial_mesh<E>(n)),
            l_shape_material, Group<Low>{}, Group<High>{});
  return adapted<E, Quadratic>(
      body, most,
      Adaptation{when<Low>(RecoveredStress{}).bulk(share).raise({.ring = 1}),
                 when<High>(RecoveredStress{}).bulk(share).refine()});
}

/// The round that ended, and the last before with at most a quarter of its unknowns.
Runs ends_of(Runs const& runs) {
  std::size_t first = runs.size() - 1;
  while (first > 0 && 4 * runs[first].n > runs.back().n) --first;
  return {runs[first], runs.back()};
}

template <Element E>
void row(Table& table, int n, long most, double rate) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto const runs = refined<E>(n, most, E::dim == 2 ? 0.5 : 0.4);
  table.converge({std::string("8, L-shape") + (E::dim == 3 ? ", extruded" : "") + ", energy norm",
                  name_of<F>(), "refined by RecoveredStress, unknowns"},
                 ends_of(runs), 0, rate);
}

template <Element E, Element Quadratic>
void mixed_row(Table& table, int n, long most, double rate) {
  auto const runs = raised_and_refined<E, Quadratic>(n, most, E::dim == 2 ? 0.5 : 0.4);
  table.converge({std::string("8, L-shape") + (E::dim == 3 ? ", extruded" : "") + ", energy norm",
                  std::string(E::name()) + " and " + Quadratic::name() + ", Gauss, Hooke",
                  "raised and refined by RecoveredStress, unknowns"},
                 ends_of(runs), 0, rate);
}

}  // namespace pliant::verification::refined_l_shape

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace verification::refined_l_shape;
  verification::Table table("L-shape, refined where the error is (8)", argc, argv);
  bool const full = table.full();
  row<Tri3>(table, 4, full ? 20000 : 4000, 0.5);
  row<Tri6>(table, 2, full ? 20000 : 4000, 1);
  mixed_row<Tri3, Tri6>(table, 4, full ? 20000 : 4000, 1);
  if constexpr (verification::has_full_form) {
    if (!full) return table.finish();
    double const of_uniform_meshes = verification::alpha / 3;
    row<Quad4>(table, 4, 20000, 0.5);
    row<Quad8>(table, 2, 20000, 1);
    row<Quad9>(table, 2, 20000, 1);
    row<Tet4>(table, 2, 60000, of_uniform_meshes);
    row<Hex8>(table, 2, 60000, of_uniform_meshes);
    row<Tet10>(table, 1, 60000, of_uniform_meshes);
    mixed_row<Quad4, Quad9>(table, 4, 20000, 1);
    mixed_row<Tet4, Tet10>(table, 2, 60000, of_uniform_meshes);
  }
  return table.finish();
}
