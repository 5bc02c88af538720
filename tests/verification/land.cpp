#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 5: problem 1 of Land et al. (2015), a beam of heart muscle under a pressure that
// follows its surface. Half of it, y >= 0.5; nearly incompressible, by a bulk modulus of 1e4 kPa on the mean
// dilatation of its elements.
namespace pliant::verification {

template <Element E>
void beam(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, FBar<Gauss<3>>, Guccione>;
  auto const runs = on_meshes(sizes, 2, [](int n) {
    auto mesh = graded<E>({n, std::max(1, n / 10), std::max(1, n / 5)}, towards_start(1.5), evenly,
                          towards_ends(1.2));
    for (auto& p : mesh.nodes) p = {10 * p[0], 0.5 + p[1] / 2, p[2]};
    std::vector<std::array<double, 3>> const fibres(mesh.template elements<E>().size(), {1, 0, 0});
    std::vector<Point<3>> u(mesh.nodes.size());
    // Each bulk modulus takes Newton's method near to the answer of the next.
    for (double bulk : {1e1, 1e2, 1e3, 1e4}) {
      Body body{Reference<double>{}, mesh, Elastic{1, 0, 1},
                Group<F>{Guccione<double>{2, 8, 2, 4, bulk}, fibres}};
      body.clamp(mesh.boundary("left"));
      body.hold(mesh.boundary("front"), 2);
      body.press(mesh.boundary("bottom"), 0.004);
      body.set_displacements(u);
      solve_static(body, {.tolerance = 1e-8});
      u = body.displacements();
    }
    auto const& tip = u[node_at(mesh, {10, 0.5, 1})];
    return std::array{1 + tip[2], tip[0]};
  });
  std::string const meshes = "graded n x n/10 x n/5";
  table.compare({"5, Land 1, z", name_of<F>(), meshes}, runs, 0, printed("4.166(3)"));
  table.compare({"5, Land 1, ux", name_of<F>(), meshes}, runs, 1, printed("-0.822(3)"));
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  using namespace pliant;
  verification::Table table("Heart muscle: Land, problem 1 (5)", argc, argv);
  verification::beam<Hex27>(table, table.full() ? std::vector{10, 20} : std::vector{10});
  return table.finish();
}
#endif
