// expect: PointLaw
#include <pliant/law/guccione.hpp>

using namespace pliant;

auto stress_of(Guccione<double> const& law, Tensor<double, 3> const& h) {
#ifdef PLIANT_MISUSE_OFF
  return stress(law.at(Vector<double, 3>{{{1}, {0}, {0}}}), h);
#else
  return stress(law, h);
#endif
}
