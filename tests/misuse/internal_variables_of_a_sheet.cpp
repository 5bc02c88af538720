// expect: Prony takes laws of solids without values per element: not PlaneStress
#include <pliant/element/linear.hpp>
#include <pliant/formulation/formulation.hpp>
#include <pliant/law/decorators/plane_stress.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/quadrature/gauss.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
using Slow = Formulation<Quad4, Gauss<2>, Prony<PlaneStress<NeoHookean>::law>::law>;
#else
using Slow = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>;
#endif

static_assert(Slow::dim == 2);
