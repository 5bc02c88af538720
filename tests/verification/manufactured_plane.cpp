#include "verification/support/manufactured.hpp"

// REFERENCES, section 9, in the plane: rates, the printed body forces, and the printed errors of another
// code on the same meshes.
namespace pliant::verification {

template <template <class> class L>
void forces(Table& table, std::string const& law, Printed const& b1, Printed const& b2) {
  auto const b = force_needed<L, 2>({0.3, 0.7});
  table.compare({"9, body force 1 at (0.3, 0.7)", law, ""}, b[0], b1);
  table.compare({"9, body force 2 at (0.3, 0.7)", law, ""}, b[1], b2);
}

template <template <class> class L>
void elements(Table& table, bool full) {
  std::vector<int> linear{8, 16, 32}, quadratic{4, 8, 16};
  if (full) {
    linear.push_back(64);
    quadratic.push_back(32);
  }
  manufactured_rows<Tri3, L>(table, linear);
  manufactured_rows<Quad4, L>(table, linear);
  manufactured_rows<Quad4, L, OnePoint>(table, linear);
  manufactured_rows<Tri6, L>(table, quadratic);
  manufactured_rows<Quad8, L>(table, quadratic);
  manufactured_rows<Quad9, L>(table, quadratic);
}

/// The other code integrates as exactly as it can; so does Q.
template <Element E, template <class> class L, class Q>
void errors(Table& table, int n, double in_u, double in_gradient) {
  auto const runs = manufactured_errors<E, L, Q>({n}, Grid::straight);
  std::string const name = name_of<Formulation<E, Q, L>>();
  table.compare({"9, error in L2 of D", name, ""}, runs, 0, within(1e-4 * in_u, in_u));
  table.compare({"9, error in H1 of D", name, ""}, runs, 1,
                within(1e-4 * in_gradient, in_gradient));
}

void tables_of_planes(Table& table) {
  forces<SaintVenantKirchhoff>(table, "SaintVenantKirchhoff", printed("0.540055446031"),
                               printed("0.785115844458"));
  forces<NeoHookean>(table, "NeoHookean", printed("0.531531413923"), printed("0.881428099783"));
  elements<SaintVenantKirchhoff>(table, table.full());
  elements<NeoHookean>(table, table.full());
  errors<Tri3, SaintVenantKirchhoff, Gauss<1>>(table, 32, 6.131511e-05, 4.571645e-03);
  errors<Tri6, SaintVenantKirchhoff, Gauss<6>>(table, 16, 2.942963e-06, 3.580657e-04);
  errors<Quad4, SaintVenantKirchhoff, Gauss<3>>(table, 32, 2.643283e-05, 2.675023e-03);
  errors<Quad9, SaintVenantKirchhoff, Gauss<5>>(table, 16, 1.308895e-06, 1.355610e-04);
  errors<Tri3, NeoHookean, Gauss<1>>(table, 32, 5.947075e-05, 4.571471e-03);
  errors<Tri6, NeoHookean, Gauss<6>>(table, 16, 2.946535e-06, 3.579576e-04);
  errors<Quad4, NeoHookean, Gauss<3>>(table, 32, 2.660333e-05, 2.675024e-03);
  errors<Quad9, NeoHookean, Gauss<5>>(table, 16, 1.308780e-06, 1.355422e-04);
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  pliant::verification::Table table("Manufactured solutions, plane (9)", argc, argv);
  pliant::verification::tables_of_planes(table);
  return table.finish();
}
