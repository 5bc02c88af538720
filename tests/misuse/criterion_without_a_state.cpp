// expect: when<F>\(criterion\): a criterion is called with the state of an element of F, and gives a number
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

#ifndef PLIANT_MISUSE_OFF
struct Stretch {
  double operator()(double length) const { return length; }
};
#else
struct Stretch {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return norm(e.gradient());
  }
};
#endif

int main() { (void)when<Linear>(Stretch{}).above(0.1).become<Rubber>(); }
