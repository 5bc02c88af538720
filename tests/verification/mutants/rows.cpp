// The rows that a mutant is asked, by the definition that tests/verification/mutate gives.
#define ROWS_OF_MUTANTS
#if defined(ROWS_PRINTED) || defined(ROWS_RUBBER) || defined(ROWS_OTHERS) || \
    defined(ROWS_ARTERIES) || defined(ROWS_INVERTED)
#include "verification/homogeneous.cpp"
#elif defined(ROWS_TENSOR) || defined(ROWS_PLANE_SIMPLEX)
#include "verification/same_mesh_plane.cpp"
#elif defined(ROWS_SOLID_SIMPLEX) || defined(ROWS_SOLID_TENSOR)
#include "verification/same_mesh_solid.cpp"
#elif defined(ROWS_MIXED)
#include "verification/support/manufactured.hpp"
#elif defined(ROWS_IMPLICIT)
#include "verification/swings.cpp"
#elif defined(ROWS_EXPLICIT)
#include "verification/same_mesh_trajectory.cpp"
#elif defined(ROWS_LOADS) || defined(ROWS_SHEET) || defined(ROWS_LOCKING)
#include "verification/cook.cpp"
#elif defined(ROWS_ONE_POINT)
#include "verification/free_faces.cpp"
#elif defined(ROWS_FOLLOWER)
#include "verification/land.cpp"
#elif defined(ROWS_VISCOUS)
#include "verification/viscosity.cpp"
#endif

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::verification;
  Table table("Rows of a mutant", argc, argv);
#if defined(ROWS_PRINTED)
  printed_laws(table);
#elif defined(ROWS_RUBBER)
  rubber(table);
  ogden(table);
#elif defined(ROWS_OTHERS)
  others(table);
#elif defined(ROWS_ARTERIES)
  arteries(table);
#elif defined(ROWS_INVERTED)
  pushed_through(table);
#elif defined(ROWS_TENSOR)
  beam<Quad4, NeoHookean>(table, -1.429046662200e-01, -4.848132827220e-01);
  beam<Quad8, NeoHookean>(table, -1.734827007617e-01, -5.291982295399e-01);
  beam<Quad9, NeoHookean>(table, -1.739011535264e-01, -5.299353600343e-01);
#elif defined(ROWS_PLANE_SIMPLEX)
  beam<Tri3, NeoHookean>(table, -6.275264377996e-02, -3.301061587812e-01);
  beam<Tri6, NeoHookean>(table, -1.734899574382e-01, -5.292350435770e-01);
#elif defined(ROWS_SOLID_SIMPLEX)
  beam<Tet4, NeoHookean>(table, -3.648903947288e-02, -5.266681407493e-01);
  beam<Tet10, NeoHookean>(table, -1.202810996625e-01, -9.515758642329e-01);
#elif defined(ROWS_SOLID_TENSOR)
  beam<Hex8, NeoHookean>(table, -9.255474177735e-02, -8.396319657727e-01);
  beam<Hex20, NeoHookean>(table, -1.203451414713e-01, -9.518366812229e-01);
#elif defined(ROWS_MIXED)
  manufactured_rows<Wedge6, NeoHookean>(table, {8, 12});
  manufactured_rows<Pyramid5, NeoHookean>(table, {8, 12});
#elif defined(ROWS_IMPLICIT)
  same_steps(table);
#elif defined(ROWS_EXPLICIT)
  fall<Quad4, NeoHookean>(table, {{100, -1.250918462340e-10, -2.000000047147e-03}});
  fall<Tri3, NeoHookean>(table, {{100, 1.509714681775e-07, -1.999963781308e-03}});
#elif defined(ROWS_LOADS)
  slab<Formulation<Hex8, Gauss<2>, SimoNeoHookean> >(table, {mu, bulk},
                                                     {{2, "8.72"}, {4, "12.02"}});
#elif defined(ROWS_SHEET)
  sheet<Quad9, Gauss<3> >(table, {12, 24, 48});
#elif defined(ROWS_LOCKING)
  meets_incompressible<Quad9>(table, {24, 48});
#elif defined(ROWS_ONE_POINT)
  one_point(table);
#elif defined(ROWS_VISCOUS)
  bars<Tet4>(table);
#elif defined(ROWS_FOLLOWER)
  beam<Hex27>(table, {10});
#endif
  return table.finish();
}
