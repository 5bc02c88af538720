#include <numbers>

#include "verification/support/grading.hpp"
#include "work_precision/mesh_contest.hpp"
#include "work_precision/reference_energy.hpp"

// A bar of 4 m × 1 m × 1 m whose end is turned by a right angle (REFERENCES, section 8): finite strain, everywhere, and
// stresses that are singular along the edges of both ends.
namespace pliant::bench {

struct TwistedBar {
  static constexpr char const* name = "twisted bar";
  static constexpr int coarse = 2;
  static constexpr double enough = 0.02;
  static constexpr long most_unknowns = 30000;
  static constexpr double length = 4;  // m
  static constexpr bool is_driven = true;
  template <class S>
  using law = NeoHookean<S>;

  /// λ = 1.5 Pa, μ = 1 Pa.
  static Elastic material() { return {.young = 2.6, .poisson = 0.3, .density = 1}; }
  template <class M>
  static M shaped(M mesh) {
    for (auto& p : mesh.nodes) p = {length * p[0], p[1] - 0.5, p[2] - 0.5};
    return mesh;
  }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return shaped(mesh::box<E>({.size = {1, 1, 1}, .cells = {4 * n, n, n}}));
  }
  /// Sections turn as far as they are along.
  static Point<3> turned(Point<3> const& X, double) {
    double const angle = std::numbers::pi / 2 * X[0] / length;
    double const c = std::cos(angle), s = std::sin(angle);
    return {0, c * X[1] - s * X[2] - X[1], s * X[1] + c * X[2] - X[2]};
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    for (char const* end : {"left", "right"}) body.drive(body.mesh().boundary(end), turned);
    auto u = body.mesh().nodes;
    for (auto& p : u) p = turned(p, 0);
    body.set_displacements(u);
  }
  template <class TheBody>
  static void load(TheBody&) {}

  /// Finer towards the ends and the sides.
  static auto graded(int n) {
    return shaped(verification::graded<Hex27>({3 * n / 2, n, n}, verification::towards_ends(2),
                                              verification::towards_ends(1.5),
                                              verification::towards_ends(1.5)));
  }
  /// J. Meshes of n = 10, 12, 14 and 16 have 0.04375301, 0.04375143, 0.04375068 and 0.04375027, whose differences fall as
  /// n⁻³·³; REFERENCES has 0.04375.
  static constexpr double reference = 0.04374953;
  template <Element... Es, class TheBody>
  static double error(TheBody const&, NewtonReport const& report) {
    return error_of(report.energy, reference);
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant::bench;
  Options const options(argc, argv);
  if (options.reference)
    print_energies<TwistedBar>({10, 12, 14, 16});
  else
    compare_solids<TwistedBar>(options);
}
