#include <numbers>

#include "verification/support/grading.hpp"
#include "verification/support/stress.hpp"

// REFERENCES, section 4: NAFEMS LE1 and LE10, a quarter of an elliptic plate with an elliptic hole, as a
// membrane and as a thick plate. Stresses are taken from the displacement gradient at the node itself.
namespace pliant::verification {

/// From the unit square: x[0] goes from the hole, semi-axes 2 and 1, to the outer edge, 3.25 and 2.75;
/// x[1] along them, from the x axis.
template <std::size_t Dim>
void bend_to_ellipses(std::vector<std::array<double, Dim>>& nodes) {
  for (auto& p : nodes) {
    double const a = 2 + 1.25 * p[0], b = 1 + 1.75 * p[0], angle = std::numbers::pi / 2 * p[1];
    p[0] = a * std::cos(angle);
    p[1] = b * std::sin(angle);
  }
}

Elastic const steel{210e3, 0.3, 1};  // MPa

template <Element E>
void membrane(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, PlaneStress<Hooke>::law>;
  auto const law = LawOf<F>::from(steel);
  auto const runs = on_meshes(sizes, 2, [&](int n) {
    auto mesh = graded<E>({n, n}, towards_start(1.5), towards_start(1.5));
    bend_to_ellipses(mesh.nodes);
    auto body = body_of<F>(mesh, law);
    body.hold(mesh.boundary("top"), 1);
    body.hold(mesh.boundary("bottom"), 2);
    body.set_loads(pressure_loads(mesh, mesh.boundary("right"), -10.0));
    solve_static(body, where_forces_cancel);
    auto const u = body.displacements();
    auto const node = node_at(mesh, {2, 0});
    return std::array{stress_at(mesh, u, law, node)(1, 1), u[node][0]};
  });
  table.compare({"4, LE1, NAFEMS stress yy", name_of<F>(), "graded n x n"}, runs, 0,
                printed("92.7"));
  if (!std::same_as<E, Tri6>)
    table.compare({"4, LE1, stress yy", name_of<F>(), "graded n x n"}, runs, 0, printed("92.659"));
  table.compare({"4, LE1, ux", name_of<F>(), "graded n x n"}, runs, 1, printed("-1.022085e-4"));
}

template <Element E>
void plate(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, Hooke>;
  auto const law = Hooke<double>::from(steel);
  auto const runs = on_meshes(sizes, 1, [&](int n) {
    auto mesh = graded<E>({n, n, n / 2}, towards_start(1.5), towards_start(1.5), towards_ends(1.5));
    bend_to_ellipses(mesh.nodes);
    for (auto& p : mesh.nodes) p[2] = 0.6 * p[2] - 0.3;
    auto body = body_of<F>(mesh, law);
    body.hold(mesh.boundary("back"), 1);
    body.hold(mesh.boundary("front"), 2);
    body.hold(mesh.boundary("right"), 3);
    std::vector<Index> line;
    for (Index i : nodes_of(mesh.boundary("right")))
      if (std::abs(mesh.nodes[static_cast<std::size_t>(i)][2]) < 1e-12) line.push_back(i);
    body.hold(line, 4);
    body.set_loads(pressure_loads(mesh, mesh.boundary("top"), 1.0));
    solve_static(body, where_forces_cancel);
    return std::array{stress_at(mesh, body.displacements(), law, node_at(mesh, {2, 0, 0.3}))(1, 1)};
  });
  // The line support has no limit (section 0): anything from -5.38 to -5.46 will do.
  table.compare({"4, LE10, stress yy", name_of<F>(), "graded n x n x n/2"}, runs, 0,
                printed("-5.42(4)"));
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  verification::Table table("NAFEMS LE1 and LE10 (4)", argc, argv);
  verification::membrane<Quad9>(table, {8, 16, 32, 64});
  verification::membrane<Quad8>(table, {8, 16, 32, 64});
  verification::membrane<Tri6>(table, {8, 16, 32, 64});
  verification::plate<Hex20>(table, {4, 6, 8});
  verification::plate<Hex27>(table, {4, 6, 8});
  if constexpr (verification::has_full_form)
    if (table.full()) verification::plate<Tet10>(table, {4, 8, 12});
  return table.finish();
}
