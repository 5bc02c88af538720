#include <pliant/pliant.hpp>

#if defined(WANT_OPENMP)
#include <pliant/openmp.hpp>
using Machine = pliant::OpenMP<double>;
#else
#if defined(_OPENMP)
#error "pliant::pliant alone must not bring OpenMP along"
#endif
#include <pliant/reference.hpp>
using Machine = pliant::Reference<double>;
#endif

#include <cstdio>

// A simulator with arrays of its own: a square of one quadrilateral and two triangles, stretched.
int main() {
  using namespace pliant;
  using Square = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Half = Formulation<Tri3, Gauss<1>, NeoHookean>;

  Mesh<Tri3, Quad4> mesh;
  mesh.nodes = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}};
  mesh.elements<Quad4>() = {{0, 1, 4, 3}};
  mesh.elements<Tri3>() = {{1, 2, 5}, {1, 5, 4}};
  Body body{Machine{}, mesh, Elastic{.young = 1e6, .poisson = 0.3, .density = 1e3}, Group<Square>{},
            Group<Half>{}};

  double u[12], f[12] = {}, mass[6] = {};
  for (int i = 0; i < 6; ++i) {
    u[2 * i] = 0.1 * mesh.nodes[static_cast<std::size_t>(i)][0];
    u[2 * i + 1] = 0;
  }
  body.add_force(u, f);
  body.add_lumped_mass(mass);
  double force = 0, total = 0;
  for (int i = 0; i < 6; ++i) {
    force += f[2 * i];
    total += mass[i];
  }
  std::printf("Pliant %d.%d.%d: energy %g J, force %g N, mass %g kg\n", version.major,
              version.minor, version.patch, body.energy(u), force, total);
  bool const right = body.energy(u) > 0 && f[0] > 0 && force * force < 1e-16 * f[0] * f[0] &&
                     (total - 2000) * (total - 2000) < 1e-12;
  return right ? 0 : 1;
}
