// expect: evaluate: a criterion is called with the state of an element of each Group, and gives a
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;

struct Gradient {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
#ifndef PLIANT_MISUSE_OFF
    return e.gradient();
#else
    return norm(e.gradient());
#endif
  }
};

int main() {
  Body const body{Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}),
                  Elastic{1, 0.3, 1}, Group<Linear>{}};
  (void)evaluate<Quad4>(body, Gradient{});
}
