// expect: estimate: only what is in joules adds up over elements
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

int main() {
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
#ifndef PLIANT_MISUSE_OFF
  using Estimates = VonMises;
#else
  using Estimates = RecoveredStress;
#endif
  Body const body{Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}),
                  Elastic{1, 0.3, 1}, Group<Linear>{}};
  (void)estimate(body, Estimates{});
}
