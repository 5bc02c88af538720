// expect: a physics for body.add has the body's dimension
#include <array>
#include <vector>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
constexpr int space = 3;
#else
constexpr int space = 2;
#endif

template <class T>
struct Anchor {
  static constexpr int nodes = 1, dim = space;
  T stiffness;
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 1, dim> const&, Matrix<S, 1, dim> const& u) const {
    return stiffness / 2 * square(u(0, 0));
  }
};

int main() {
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
  Body body{Reference<double>{}, mesh::rectangle({{1, 1}, {1, 1}}), {1, 0.3, 1}, Group<Linear>{}};
  body.add(std::vector<std::array<Index, 1>>{{0}}, Anchor<double>{1});
}
