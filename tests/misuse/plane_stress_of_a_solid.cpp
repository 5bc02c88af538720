// expect: this law is that of a plane body
#include <pliant/law/decorators/plane_stress.hpp>
#include <pliant/law/neo_hookean.hpp>

using namespace pliant;

#ifdef PLIANT_MISUSE_OFF
constexpr int dim = 2;
#else
constexpr int dim = 3;
#endif

auto force_of(PlaneStress<NeoHookean>::law<double> const& law, Tensor<double, dim> const& h) {
  return stress(law, h);
}
