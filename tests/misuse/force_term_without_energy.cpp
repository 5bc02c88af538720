// expect: a physics for body.add has energy\(rest, u\) or force\(rest, u\)
#include <array>
#include <vector>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

using namespace pliant;

template <class T>
struct Spring {
  static constexpr int nodes = 2, dim = 2;
  T stiffness;
#ifdef PLIANT_MISUSE_OFF
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 2, 2> const&, Matrix<S, 2, 2> const& u) const {
    return stiffness / 2 * square(u(1, 0) - u(0, 0));
  }
#endif
};

int main() {
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
  Body body{Reference<double>{}, mesh::rectangle({{1, 1}, {1, 1}}), {1, 0.3, 1}, Group<Linear>{}};
  body.add(std::vector<std::array<Index, 2>>{{0, 1}}, Spring<double>{1});
}
