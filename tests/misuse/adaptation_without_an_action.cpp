// expect: Rule
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

int main() {
  auto const marked = when<Linear>(Rotation{}).above(0.1);
#ifndef PLIANT_MISUSE_OFF
  Adaptation adapt{marked};
#else
  Adaptation adapt{marked.become<Rubber>()};
#endif
  (void)adapt;
}
