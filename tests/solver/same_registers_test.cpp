#include <pliant/solve.hpp>

#include "support/formulations.hpp"

// What solvers do in programs whose sources are compiled for registers of several widths, which misuse/two_processors makes.
namespace pliant::test::same_registers_test {

using F = Formulation<Tri3, Gauss<1>, Hooke>;

/// As if one more source were compiled for others.
class OtherSource {
 public:
  OtherSource() { detail::eigen_alignments |= other; }
  ~OtherSource() { detail::eigen_alignments &= ~other; }

 private:
  static constexpr unsigned other = 1u << 16;
};

TEST_CASE("all that solves or assembles asks for one width of registers", "[solver]") {
  auto const mesh = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {2, 2}});
  Body body{Reference<double>{}, mesh, soft, Group<F>{}};
  auto const left = body.clamp(mesh.boundary("left"));
  Eigen::VectorXd const u = Eigen::VectorXd::Zero(2 * body.nodes());
  Implicit step{BackwardEuler{}, {.step = 1e-3}};
  {
    OtherSource const other;
    auto const refusal = says("the same -march");
    CHECK_THROWS_WITH(solve_static(body), refusal);
    CHECK_THROWS_WITH(follow_path(body, {}, [](PathPoint const&) { return false; }), refusal);
    CHECK_THROWS_WITH(step(body), refusal);
    CHECK_THROWS_WITH(assemble(body, u), refusal);
    CHECK_THROWS_WITH(assemble_mass(body), refusal);
    CHECK_THROWS_WITH(static_reactions(body, left), refusal);
    CHECK(body.steps() == 0);
  }
  CHECK_NOTHROW(solve_static(body));
}

}  // namespace pliant::test::same_registers_test
