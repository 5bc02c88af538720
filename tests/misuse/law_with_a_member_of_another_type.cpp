// expect: every member of a law L<T> must be of type T
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

template <class T>
struct Power {
  T modulus;
#ifndef PLIANT_MISUSE_OFF
  int exponent;
#else
  T exponent;
#endif
  template <class S>
  PLIANT_HOST_DEVICE S energy(StrainInvariants<S> const& e) const {
    return modulus * e.squares;
  }
};

int main() {
  Reference<float> backend;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  using Powers = Formulation<Quad4, Gauss<2>, Power>;
  Body body{backend, mesh, Elastic{1, 0.3, 1}, Group<Powers>{Power<double>{1, 2}}};
}
