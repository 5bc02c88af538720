#pragma once

#include "support/formulations.hpp"

// One body for each element type, to look at criteria.
namespace pliant::test {

template <Element E>
using LinearOn = Formulation<E, std::conditional_t<LinearSimplex<E>, Gauss<1>, Gauss<2>>, Hooke>;

/// Calls visit(backend, E{}) for each backend and element type: all of them on the main backend, one in the plane and
/// one in space on the other of a CPU.
template <class Bs, class Visit>
void on_each_element(Visit const& visit) {
  on_each_backend<Bs>([&]<class B>(B const& backend) {
    SECTION("Tri3") { visit(backend, Tri3{}); }
    if constexpr (runs_all<B>) {
      SECTION("Quad4") { visit(backend, Quad4{}); }
      SECTION("Tet4") { visit(backend, Tet4{}); }
    }
    SECTION("Hex8") { visit(backend, Hex8{}); }
  });
}

/// A mesh of one element.
template <Element E>
Mesh<E> single(std::vector<Point<E::dim>> const& nodes) {
  Mesh<E> mesh;
  mesh.nodes = nodes;
  Connectivity<E> element;
  for (std::size_t a = 0; a < element.size(); ++a) element[a] = static_cast<Index>(a);
  mesh.template elements<E>().push_back(element);
  return mesh;
}

/// A criterion of every element of a mesh that is displaced.
template <Element E, class B, class M, class Criterion>
std::vector<double> values_at(B const& backend, M const& mesh,
                              FieldOf<std::size_t{E::dim}> const& u, Criterion const& criterion) {
  auto body = body_of<LinearOn<E>>(backend, mesh);
  body.set_displacements(u);
  return evaluate<E>(body, criterion);
}

/// The rotation by an angle about an axis (Rodrigues); in 2D the axis does not matter.
template <int Dim>
Tensor<double, Dim> turn(double angle, Point<3> const& axis = {0, 0, 1}) {
  double const c = std::cos(angle), s = std::sin(angle);
  if constexpr (Dim == 2) {
    return {{{c, -s}, {s, c}}};
  } else {
    double const size = std::hypot(axis[0], axis[1], axis[2]);
    double const n[3] = {axis[0] / size, axis[1] / size, axis[2] / size};
    Tensor<double, 3> r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        int const k = 3 - i - j;
        double const cross = i == j ? 0 : ((j - i + 3) % 3 == 1 ? -n[k] : n[k]);
        r(i, j) = (1 - c) * n[i] * n[j] + (i == j ? c : s * cross);
      }
    return r;
  }
}
/// F − I.
template <int Dim>
Tensor<double, Dim> less_identity(Tensor<double, Dim> f) {
  for (int i = 0; i < Dim; ++i) f(i, i) -= 1;
  return f;
}

}  // namespace pliant::test
