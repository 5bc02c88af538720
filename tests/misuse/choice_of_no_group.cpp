// expect: a choice names a formulation of which the body has no Group
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

int main() {
#ifndef PLIANT_MISUSE_OFF
  using Cheap = Turning;
#else
  using Cheap = Linear;
#endif
  Body body{Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}),
            Elastic{1, 0.3, 1}, Group<Linear>{}, Group<Rubber>{}};
  Adaptation{within<Cheap, Rubber>({.error = 1e-3})}.now(body);
}
