#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 1: the beam of Turek and Hron under its weight, held by a cylinder (CSM1, CSM2), and
// the same beam with a straight clamp.
namespace pliant::verification {

enum class Clamp { cylinder, straight };

/// n/4 elements across, graded towards the corners at the clamp.
template <Element E>
Mesh<E> flag(int n, Clamp clamp) {
  auto mesh = graded<E>({n, n / 4}, towards_start(2.5), towards_ends(2.5));
  for (auto& p : mesh.nodes) {
    double const y = 0.19 + 0.02 * p[1];
    double const left =
        clamp == Clamp::straight ? 0.25 : 0.2 + std::sqrt(square(0.05) - square(y - 0.2));
    p = {left + (0.6 - left) * p[0], y};
  }
  return mesh;
}

struct Tip {
  Printed ux, uy;
};

template <Element E>
void sag(Table& table, std::string const& problem, Clamp clamp, double young, Tip const& tip,
         std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, SaintVenantKirchhoff>;
  auto const runs = on_meshes(sizes, 2, [&](int n) {
    auto const mesh = flag<E>(n, clamp);
    auto body = body_of<F>(mesh, {young, 0.4, 1000});
    body.clamp(mesh.boundary("left"));
    body.set_loads(body_loads(mesh, Point<2>{0, -2000}));
    solve_static(body, where_forces_cancel);
    return body.displacements()[node_at(mesh, {0.6, 0.2})];
  });
  table.compare({"1, " + problem + ", ux(A)", name_of<F>(), "graded n x n/4"}, runs, 0, tip.ux);
  table.compare({"1, " + problem + ", uy(A)", name_of<F>(), "graded n x n/4"}, runs, 1, tip.uy);
}

void sags(Table& table) {
  Tip const csm1{printed("-7.1878e-3"), printed("-66.103e-3")};
  Tip const csm2{printed("-0.46901e-3"), printed("-16.974e-3")};
  Tip const csm1_straight{printed("-7.0866e-3"), printed("-65.567e-3")};
  Tip const csm2_straight{printed("-0.46216e-3"), printed("-16.831e-3")};
  std::vector<int> const sizes{16, 32, 64};
  sag<Quad9>(table, "CSM1", Clamp::cylinder, 1.4e6, csm1, sizes);
  sag<Quad8>(table, "CSM1", Clamp::cylinder, 1.4e6, csm1, sizes);
  sag<Tri6>(table, "CSM1", Clamp::cylinder, 1.4e6, csm1, {24, 48, 96});
  sag<Quad9>(table, "CSM2", Clamp::cylinder, 5.6e6, csm2, sizes);
  sag<Quad8>(table, "CSM2", Clamp::cylinder, 5.6e6, csm2, sizes);
  sag<Tri6>(table, "CSM2", Clamp::cylinder, 5.6e6, csm2, {24, 48, 96});
  sag<Quad9>(table, "CSM1-rect", Clamp::straight, 1.4e6, csm1_straight, {20, 40, 80});
  sag<Quad9>(table, "CSM2-rect", Clamp::straight, 5.6e6, csm2_straight, sizes);
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  pliant::verification::Table table("Beam of Turek and Hron at rest: CSM1, CSM2 (1)", argc, argv);
  pliant::verification::sags(table);
  return table.finish();
}
