#include "verification/support/statics.hpp"

// REFERENCES, section 12a: the plane cantilever of section 10 on 20 x 2 cells, by two other codes on the
// same mesh.
namespace pliant::verification {

template <class F>
void beam(Table& table, double ux, double uy) {
  using E = typename F::element;
  auto const tip = on_meshes({20}, 2, [](int n) {
    auto const mesh =
        mesh::rectangle<E>({.size = {1, 0.1}, .cells = {n, n / 10}, .origin = {0, -0.05}});
    auto body = body_of<F>(mesh, {2e6, 0.3, 1000});
    body.clamp(mesh.boundary("left"));
    body.set_loads(body_loads(mesh, Point<2>{0, -1e4}));
    solve_static(body);
    return body.displacements()[node_at(mesh, {1, 0})];
  });
  double const digits = 1e-9 * std::abs(uy);
  table.compare({"12a, ux", name_of<F>(), "n x n/10"}, tip, 0, within(digits, ux));
  table.compare({"12a, uy", name_of<F>(), "n x n/10"}, tip, 1, within(digits, uy));
}

template <Element E, template <class> class L>
void beam(Table& table, double ux, double uy) {
  beam<Formulation<E, Full<E>, L>>(table, ux, uy);
}

void tables(Table& table) {
  beam<Tri3, SaintVenantKirchhoff>(table, -6.276797374995e-02, -3.265342253317e-01);
  beam<Quad4, SaintVenantKirchhoff>(table, -1.448088958555e-01, -4.848352967743e-01);
  beam<Quad8, SaintVenantKirchhoff>(table, -1.753588012303e-01, -5.287924540456e-01);
  beam<Quad9, SaintVenantKirchhoff>(table, -1.757903776854e-01, -5.295463096961e-01);
  beam<Tri6, SaintVenantKirchhoff>(table, -1.753368136063e-01, -5.287751655706e-01);
  beam<Tri3, NeoHookean>(table, -6.275264377996e-02, -3.301061587812e-01);
  beam<Quad4, NeoHookean>(table, -1.429046662200e-01, -4.848132827220e-01);
  beam<Quad8, NeoHookean>(table, -1.734827007617e-01, -5.291982295399e-01);
  beam<Quad9, NeoHookean>(table, -1.739011535264e-01, -5.299353600343e-01);
  beam<Tri6, NeoHookean>(table, -1.734899574382e-01, -5.292350435770e-01);
  beam<Tri3, Hooke>(table, -3.083888194534e-04, -3.572160797204e-01);
  beam<Quad4, Hooke>(table, 0, -5.980259629225e-01);
  beam<Quad8, Hooke>(table, 0, -6.841737832875e-01);
  beam<Quad9, Hooke>(table, 0, -6.855066061240e-01);
  beam<Tri6, Hooke>(table, -1.310334178666e-05, -6.840252839341e-01);
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  pliant::verification::Table table("Same mesh, plane (12a)", argc, argv);
  pliant::verification::tables(table);
  return table.finish();
}
#endif
