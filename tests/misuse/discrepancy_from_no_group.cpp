// expect: a criterion compares with a formulation of which the body has no Group
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

int main() {
#ifndef PLIANT_MISUSE_OFF
  using To = Rubber;
#else
  using To = Linear;
#endif
  Body const body{Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}),
                  Elastic{1, 0.3, 1}, Group<Linear>{}};
  (void)evaluate<Quad4>(body, LawDiscrepancy<To>{});
}
