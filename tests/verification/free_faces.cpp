#include "verification/support/statics.hpp"

// REFERENCES, section 6: a stretch along x with free faces, in space, in plane strain and in plane stress.
namespace pliant::verification {

/// l2, how far the sides end up apart, and P11, the pull at the right side.
template <class F>
std::vector<double> pulled(LawOf<F> const& law, double stretch) {
  using E = typename F::element;
  constexpr int dim = E::dim;
  Mesh<E> mesh;
  if constexpr (dim == 2)
    mesh = mesh::rectangle<E>({.size = {1, 1}, .cells = {2, 2}});
  else
    mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {2, 2, 2}});
  auto body = body_of<F>(mesh, law);
  auto u = mesh.nodes;
  for (auto& p : u) {
    double const x = p[0];
    p = {};
    p[0] = (stretch - 1) * x;
  }
  body.set_displacements(u);
  body.hold(mesh.boundary("left"), 1);
  body.hold(mesh.boundary("right"), 1);
  body.hold(mesh.boundary(dim == 2 ? "bottom" : "front"), 2);
  if constexpr (dim == 3) body.hold(mesh.boundary("bottom"), 4);
  solve_static(body);
  Point<dim> far;
  far.fill(1);
  double pull = 0;
  auto const forces = body.forces();
  for (Index n : nodes_of(mesh.boundary("right"))) pull -= forces[static_cast<std::size_t>(n)][0];
  return {1 + body.displacements()[node_at(mesh, far)][1], pull};
}

template <class F>
void row(Table& table, std::string const& state, LawOf<F> const& law, double stretch, double l2,
         double p11) {
  auto const found = on_meshes({2}, 2, [&](int) { return pulled<F>(law, stretch); });
  std::string const where = "6, " + state + " at " + number(stretch);
  table.compare({where + ", l2", name_of<F>(), ""}, found, 0, within(1e-11, l2));
  table.compare({where + ", P11", name_of<F>(), ""}, found, 1, within(1e-11, p11));
}

struct Free {
  double stretch, l2, p11, plane_l2, plane_p11;
};

template <template <class> class L>
void rows(Table& table, L<double> const& law, std::vector<Free> const& states) {
  for (auto const& s : states) {
    row<Formulation<Hex8, Gauss<2>, L>>(table, "uniaxial stress", law, s.stretch, s.l2, s.p11);
    row<Formulation<Quad4, Gauss<2>, L>>(table, "plane strain", law, s.stretch, s.plane_l2,
                                         s.plane_p11);
    row<Formulation<Quad4, Gauss<2>, PlaneStress<L>::template law>>(table, "plane stress", {{law}},
                                                                    s.stretch, s.l2, s.p11);
  }
}

/// Faces are free to move in hourglasses, were these not held.
void one_point(Table& table) {
  NeoHookean<double> const law{3, 2};
  row<Formulation<Hex8, OnePoint, NeoHookean>>(table, "uniaxial stress", law, 1.2, .945632624291,
                                               .909631566460);
  row<Formulation<Quad4, OnePoint, NeoHookean>>(table, "plane strain", law, 1.2, .921495438379,
                                                .984743595076);
}

void tables(Table& table) {
  double const lambda = 3, mu = 2, bulk = 5;
  rows<Hooke>(table, {lambda, mu}, {{1.2, .94, 1.04, .914285714286, 1.142857142857}});
  rows<SaintVenantKirchhoff>(table, {lambda, mu},
                             {{1.2, .931665175908, 1.3728, .900793301168, 1.508571428571},
                              {.7, 1.073778375644, -.9282, 1.103889228397, -1.02}});
  rows<NeoHookean>(table, {lambda, mu},
                   {{1.2, .945632624291, .909631566460, .921495438379, .984743595076},
                    {.7, 1.107934732848, -2.107198206434, 1.150796046330, -2.383804400713}});
  rows<IsochoricNeoHookean>(
      table, {mu, bulk},
      {{1.2, .942559609546, .880898256862, .909018816976, .965216409138},
       {.7, 1.117013463364, -2.369355752576, 1.129489266723, -2.625592789092}});
  rows<MooneyRivlin>(table, {.75, .25, bulk},
                     {{1.2, .941647717155, .851771181455, .909459014741, .950007854705}});
  one_point(table);
}

}  // namespace pliant::verification

#if !defined(ROWS_OF_MUTANTS)
int main(int argc, char** argv) {
  pliant::verification::Table table("Stretch with free faces (6)", argc, argv);
  pliant::verification::tables(table);
  return table.finish();
}
#endif
