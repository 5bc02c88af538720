#include "verification/support/statics.hpp"

// REFERENCES, section 12b: the solid cantilever of section 8 on 8 x 2 x 2 cells, by two other codes on
// the same mesh.
namespace pliant::verification {

template <Element E, template <class> class L>
void beam(Table& table, double ux, double uy) {
  using F = Formulation<E, Full<E>, L>;
  auto const tip = on_meshes({8}, 2, [](int n) {
    auto const mesh =
        mesh::box<E>({.size = {4, 1, 1}, .cells = {n, n / 4, n / 4}, .origin = {0, -0.5, -0.5}});
    auto body = body_of<F>(mesh, {4e6, 0.3, 1000});
    body.clamp(mesh.boundary("left"));
    body.set_loads(body_loads(mesh, Point<3>{0, -1e4, 0}));
    solve_static(body);
    return body.displacements()[node_at(mesh, {4, 0, 0})];
  });
  // The two codes agree to 8 digits on Tet10, where they round the constants of the rule otherwise.
  double const digits = (std::same_as<E, Tet10> ? 1e-8 : 1e-9) * std::abs(uy);
  table.compare({"12b, ux", name_of<F>(), "n x n/4 x n/4"}, tip, 0, within(digits, ux));
  table.compare({"12b, uy", name_of<F>(), "n x n/4 x n/4"}, tip, 1, within(digits, uy));
}

void tables(Table& table) {
  beam<Tet4, SaintVenantKirchhoff>(table, -3.927585880596e-02, -5.156697721458e-01);
  beam<Hex8, SaintVenantKirchhoff>(table, -9.980319744908e-02, -8.402461146258e-01);
  beam<Tet10, SaintVenantKirchhoff>(table, -1.286694117179e-01, -9.512342481044e-01);
  beam<Hex20, SaintVenantKirchhoff>(table, -1.289532668415e-01, -9.522847099482e-01);
  beam<Hex27, SaintVenantKirchhoff>(table, -1.300112708974e-01, -9.568147490647e-01);
  beam<Tet4, NeoHookean>(table, -3.648903947288e-02, -5.266681407493e-01);
  beam<Hex8, NeoHookean>(table, -9.255474177735e-02, -8.396319657727e-01);
  beam<Hex27, NeoHookean>(table, -1.213469666736e-01, -9.563053556999e-01);
  beam<Tet4, Hooke>(table, -1.859381783573e-03, -5.257843533908e-01);
  beam<Hex20, Hooke>(table, 0, -9.875451516928e-01);
  if constexpr (has_full_form) {
    beam<Tet10, NeoHookean>(table, -1.202810996625e-01, -9.515758642329e-01);
    beam<Hex20, NeoHookean>(table, -1.203451414713e-01, -9.518366812229e-01);
    beam<Tet10, Hooke>(table, -5.597501212751e-05, -9.865728067353e-01);
    beam<Hex8, Hooke>(table, 0, -8.647050445904e-01);
    beam<Hex27, Hooke>(table, 0, -9.924089508893e-01);
  }
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  pliant::verification::Table table("Same mesh, solid (12b)", argc, argv);
  pliant::verification::tables(table);
  return table.finish();
}
#endif
