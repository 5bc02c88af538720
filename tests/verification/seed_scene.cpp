#include "verification/support/grading.hpp"
#include "verification/support/statics.hpp"

// REFERENCES, section 10: the plane cantilever of 10 to 1 under its weight, converged.
namespace pliant::verification {

template <Element E, template <class> class L, class Q = Full<E>>
void hang(Table& table, Printed const& ux, Printed const& uy, Printed const& energy,
          std::vector<int> const& sizes, double power) {
  using F = Formulation<E, Q, L>;
  auto const runs = on_meshes(sizes, 3, [&](int n) {
    auto mesh = graded<E>({n, n / 4}, towards_start(power), towards_ends(power));
    for (auto& p : mesh.nodes) p[1] = 0.1 * p[1] - 0.05;
    auto body = body_of<F>(mesh, {2e6, 0.3, 1000});
    body.clamp(mesh.boundary("left"));
    body.set_loads(body_loads(mesh, Point<2>{0, -1e4}));
    auto const report = solve_static(body, {.load_steps = 3, .tolerance = 1e-7});
    auto const tip = body.displacements()[node_at(mesh, {1, 0})];
    return std::array{tip[0], tip[1], report.energy};
  });
  table.compare({"10, ux", name_of<F>(), "graded n x n/4"}, runs, 0, ux);
  table.compare({"10, uy", name_of<F>(), "graded n x n/4"}, runs, 1, uy);
  if (!energy.text.empty())
    table.compare({"10, energy", name_of<F>(), "graded n x n/4"}, runs, 2, energy);
}

void cantilevers_at_rest(Table& table) {
  Printed const zero = within(1e-11, 0);
  [[maybe_unused]] Printed const none{};
  std::vector<int> const sizes{28, 56, 112};
  hang<Quad9, Hooke>(table, zero, printed("-0.687337"), printed("138.3506"), sizes, 3);
  // With 3 x 3 points, the smallest elements at the corners find folds that the points do not see.
  hang<Quad9, NeoHookean, Gauss<4>>(table, printed("-0.17452"), printed("-0.53101"),
                                    printed("97.3146"), sizes, 3);
  auto const svk = [&]<Element E>(E, std::vector<int> const& n) -> void {
    // This law softens in compression: no strong grading at the corners, where it has no answer (section 0).
    hang<E, SaintVenantKirchhoff>(table, printed("-0.1764"), printed("-0.5307(1)"), printed("97.2"),
                                  n, 1.5);
  };
  svk(Quad9{}, {16, 32, 64});
  if constexpr (has_full_form) {
    if (!table.full()) return;
    hang<Quad8, NeoHookean>(table, printed("-0.17452"), printed("-0.53101"), none, {16, 32, 64}, 3);
    hang<Tri6, NeoHookean>(table, printed("-0.17452"), printed("-0.53101"), none, {24, 48, 96}, 3);
    svk(Quad8{}, {16, 32, 64});
    svk(Tri6{}, {24, 48, 96});
  }
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  pliant::verification::Table table("Cantilever of 10 to 1 (10)", argc, argv);
  pliant::verification::cantilevers_at_rest(table);
  return table.finish();
}
