#include "verification/support/statics.hpp"

// REFERENCES, section 12c: the beam of section 12a let go from rest, by another code with the same mesh,
// lumped masses and steps.
namespace pliant::verification {

struct Instant {
  int steps;
  double ux, uy;
};

template <Element E, template <class> class L>
void fall(Table& table, std::vector<Instant> const& instants) {
  using F = Formulation<E, Full<E>, L>;
  auto const mesh = mesh::rectangle<E>({.size = {1, 0.1}, .cells = {20, 2}, .origin = {0, -0.05}});
  auto body = body_of<F>(mesh, {2e6, 0.3, 1000});
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -10});
  auto const tip = node_at(mesh, {1, 0});
  CentralDifference step{{.step = 2e-4}};
  for (auto const& at : instants) {
    std::string const time = number(2e-4 * at.steps) + " s";
    auto const u = on_meshes({20}, 2, [&](int) {
      step(body, at.steps - static_cast<int>(body.steps()));
      return body.displacements()[tip];
    });
    double const digits = 1e-9 * std::abs(at.uy);
    table.compare({"12c, ux after " + time, name_of<F>(), "n x n/10"}, u, 0, within(digits, at.ux));
    table.compare({"12c, uy after " + time, name_of<F>(), "n x n/10"}, u, 1, within(digits, at.uy));
  }
}

void tables(Table& table) {
  fall<Quad4, SaintVenantKirchhoff>(table, {{100, -8.796996116906e-10, -2.000000047147e-03},
                                            {500, -1.854916961551e-03, -5.840305004391e-02},
                                            {1000, -4.521039402819e-02, -2.790526721452e-01}});
  fall<Quad4, NeoHookean>(table, {{100, -1.250918462340e-10, -2.000000047147e-03},
                                  {500, -1.736289702303e-03, -5.838995265341e-02},
                                  {1000, -4.470687831339e-02, -2.791411757717e-01}});
  fall<Quad4, Hooke>(table, {{100, 0, -2.000000047147e-03},
                             {500, 0, -5.835775223362e-02},
                             {1000, 0, -2.860179793485e-01}});
  fall<Tri3, SaintVenantKirchhoff>(table, {{100, 1.504781685500e-07, -1.999963947792e-03},
                                           {500, -2.073686471524e-03, -6.544626599955e-02},
                                           {1000, -3.819213832554e-02, -2.587387548601e-01}});
  fall<Tri3, NeoHookean>(table, {{100, 1.509714681775e-07, -1.999963781308e-03},
                                 {500, -1.958083082173e-03, -6.540754996708e-02},
                                 {1000, -3.748414682067e-02, -2.591036503649e-01}});
  fall<Tri3, Hooke>(table, {{100, 1.509438904315e-07, -1.999963774975e-03},
                            {500, -1.170511652498e-04, -6.542257156643e-02},
                            {1000, -2.176457756593e-04, -2.642224320647e-01}});
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  pliant::verification::Table table("Same mesh and steps, lumped masses (12c)", argc, argv);
  pliant::verification::tables(table);
  return table.finish();
}
#endif
