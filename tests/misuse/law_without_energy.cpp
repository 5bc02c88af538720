// expect: Law<
#include <pliant/pliant.hpp>

using namespace pliant;

template <class T>
struct Stiff {
  T modulus;
#ifdef PLIANT_MISUSE_OFF
  template <class S>
  S energy(StrainInvariants<S> const& e) const {
    return modulus * e.squares;
  }
#endif
};

static_assert(Formulation<Quad4, Gauss<2>, Stiff>::points == 4);
