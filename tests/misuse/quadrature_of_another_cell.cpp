// expect: QuadratureOn
#include <pliant/pliant.hpp>

using namespace pliant;

/// The trapezoidal rule of the square, and of no other cell.
struct Trapezoidal {
  template <class Cell>
    requires std::same_as<Cell, Quadrilateral>
  static constexpr QuadratureRule<2, 4> rule() {
    return {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {1, 1, 1, 1}};
  }
};

#ifndef PLIANT_MISUSE_OFF
using Wrong = Formulation<Tri3, Trapezoidal, Hooke>;
#else
using Wrong = Formulation<Quad4, Trapezoidal, Hooke>;
#endif

static_assert(Wrong::dim == 2);
