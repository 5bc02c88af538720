// expect: KelvinVoigt takes laws of solids without values per element: .*laws of fibres
#include <pliant/element/linear.hpp>
#include <pliant/formulation/formulation.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/law/guccione.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/quadrature/gauss.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Slow = Formulation<Hex8, Gauss<2>, KelvinVoigt<Guccione>::law>;
#else
using Slow = Formulation<Hex8, Gauss<2>, KelvinVoigt<NeoHookean>::law>;
#endif

static_assert(Slow::dim == 3);
