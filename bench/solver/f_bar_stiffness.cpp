#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include <pliant/formulation/physics.hpp>
#include <pliant/law/hooke.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/mesh/box.hpp>
#include <pliant/mesh/raised.hpp>
#include <pliant/mesh/rectangle.hpp>

// What the stiffness of an element under a mean dilatation costs, in evaluations of its force, beside the same matrix
// column by column from products of the tangent. Both run in turns in one program, on one core; the least times count.
namespace pliant::bench {

template <class F, class S>
Tensor<S, F::nodes * F::dim> by_columns(typename F::template law<S> const& law,
                                        Nodal<typename F::element, S> const& rest,
                                        Nodal<typename F::element, S> const& u) {
  constexpr int size = F::nodes * F::dim;
  Tensor<S, size> k;
  for (int column = 0; column < size; ++column) {
    auto du = Nodal<typename F::element, S>::zero();
    du(column / F::dim, column % F::dim) = 1;
    auto const df = tangent_product<F>(law, rest, u, du);
    for (int row = 0; row < size; ++row) k(row, column) = -df(row / F::dim, row % F::dim);
  }
  return k;
}

/// The least seconds of a call among so many turns of so many calls, so far.
template <class Call>
void time(double& least, int calls, Call const& call) {
  using Clock = std::chrono::steady_clock;
  auto const start = Clock::now();
  for (int k = 0; k < calls; ++k) call();
  least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count() / calls);
}

template <class F, class M>
void compare(char const* law_name, M const& mesh) {
  using E = typename F::element;
  auto const law = F::template law<double>::from({2e6, 0.49, 1e3});
  auto const rest = nodal(mesh, mesh.template elements<E>()[0]);
  Nodal<E, double> u;
  for (int a = 0; a < F::nodes; ++a)
    for (int i = 0; i < F::dim; ++i) u(a, i) = 0.02 * std::sin(7.0 * a + 3.0 * i + 1);
  double constexpr none = std::numeric_limits<double>::infinity();
  double force_time = none, stiffness_time = none, columns_time = none, off = 0, largest = 0;
  double volatile used;                          // written, so that calls are made
  auto const moved = [&] { u(0, 0) += 1e-12; };  // so that nothing is computed once for all calls
  for (int turn = 0; turn < 15; ++turn) {
    time(force_time, 200, [&] {
      moved();
      used = force<F>(law, rest, u)(0, 0);
    });
    time(stiffness_time, 20, [&] {
      moved();
      used = stiffness<F>(law, rest, u)(0, 0);
    });
    time(columns_time, 3, [&] {
      moved();
      used = by_columns<F>(law, rest, u)(0, 0);
    });
  }
  auto const now = stiffness<F>(law, rest, u), then = by_columns<F>(law, rest, u);
  for (int i = 0; i < F::nodes * F::dim; ++i)
    for (int j = 0; j < F::nodes * F::dim; ++j) {
      off = std::max(off, std::abs(now(i, j) - then(i, j)));
      largest = std::max(largest, std::abs(then(i, j)));
    }
  std::printf(R"(  {"element": "%s", "law": "%s", "force_us": %.3g, "forces_per_stiffness": %.3g, )"
              R"("forces_by_columns": %.3g, "difference": %.1e})",
              E::name(), law_name, 1e6 * force_time, stiffness_time / force_time,
              columns_time / force_time, off / largest);
}

}  // namespace pliant::bench

int main() {
  using namespace pliant;
  auto const bricks = mesh::box<Hex8>({.size = {1, 1.1, 0.9}, .cells = {1, 1, 1}});
  auto const tetrahedra = mesh::box<Tet4>({.size = {1, 1.1, 0.9}, .cells = {1, 1, 1}});
  auto const squares = mesh::rectangle<Quad4>({.size = {1, 1.1}, .cells = {1, 1}});
  std::puts("[");
  bench::compare<Formulation<Hex27, FBar<Gauss<3>>, NeoHookean>>("NeoHookean",
                                                                 mesh::raised<Hex27>(bricks));
  std::puts(",");
  bench::compare<Formulation<Hex27, FBar<Gauss<3>>, Hooke>>("Hooke", mesh::raised<Hex27>(bricks));
  std::puts(",");
  bench::compare<Formulation<Tet10, FBar<Gauss<3>>, NeoHookean>>("NeoHookean",
                                                                 mesh::raised<Tet10>(tetrahedra));
  std::puts(",");
  bench::compare<Formulation<Hex8, FBar<Gauss<2>>, NeoHookean>>("NeoHookean", bricks);
  std::puts(",");
  bench::compare<Formulation<Quad9, FBar<Gauss<3>>, NeoHookean>>("NeoHookean",
                                                                 mesh::raised<Quad9>(squares));
  std::puts("\n]");
}
