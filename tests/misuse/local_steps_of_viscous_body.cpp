// expect: LocalSteps takes no laws whose stress depends on how fast they deform
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#include <pliant/solver/local_steps.hpp>

using namespace pliant;

int main() {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
#ifndef PLIANT_MISUSE_OFF
  using F = Formulation<Quad4, Gauss<2>, KelvinVoigt<NeoHookean>::law>;
  Group<F> const group{{{{3, 2}, 0.5}}};
#else
  using F = Formulation<Quad4, Gauss<2>, NeoHookean>;
  Group<F> const group{{{3, 2}}};
#endif
  Body body{Reference<double>{}, mesh, Elastic{5.2, 0.3, 1}, group};
  LocalSteps step;
  step(body);
}
