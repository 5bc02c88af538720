#include <pliant/mesh/loads.hpp>

#include "scene/carve.hpp"
#include "verification/support/grading.hpp"
#include "work_precision/mesh_contest.hpp"
#include "work_precision/reference_energy.hpp"

// A block of 4 m × 2 m × 2 m, pulled at its ends, with notches in the middle of its top and bottom that reach over half of
// them; an eighth of it. Each notch ends in three re-entrant edges that meet, and the field is singular along them.
namespace pliant::bench {

struct NotchedBlock {
  static constexpr char const* name = "notched block";
  static constexpr int coarse = 2;
  static constexpr double enough = 0.03;
  static constexpr long most_unknowns = 30000;
  static constexpr bool is_driven = false;
  template <class S>
  using law = Hooke<S>;

  static Elastic material() { return {.young = 1e5, .poisson = 0.3, .density = 1}; }

  /// [0, 2] × [0, 1]² without [0, 0.5]² × [0.5, 1]: 2n × n × n cells, n even, in the unit cube before `place` moves their
  /// corners.
  template <Element E, class Place>
  static Mesh<E> mesh(int n, Place const& place) {
    using Linear = verification::LinearOn<E>;
    auto block =
        scene::carve(mesh::box<Linear>({.size = {1, 1, 1}, .cells = {2 * n, n, n}}),
                     [](Point<3> const& p) { return p[0] < 0.25 && p[1] < 0.5 && p[2] > 0.5; });
    auto const side = [&](std::size_t k, double at) {
      return mesh::outer_sides_where(block,
                                     [=](Point<3> const& p) { return std::abs(p[k] - at) < 1e-9; });
    };
    block.boundaries = {
        {"x = 0", side(0, 0)}, {"y = 0", side(1, 0)}, {"z = 0", side(2, 0)}, {"end", side(0, 1)}};
    for (auto& p : block.nodes) p = place(p);
    if constexpr (E::degree > 1)
      return mesh::raised<E>(block);
    else
      return block;
  }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return mesh<E>(n, [](Point<3> const& p) { return Point<3>{2 * p[0], p[1], p[2]}; });
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.hold(body.mesh().boundary("x = 0"), 1);  // along x
    body.hold(body.mesh().boundary("y = 0"), 2);  // along y
    body.hold(body.mesh().boundary("z = 0"), 4);  // along z
  }
  template <class TheBody>
  static void load(TheBody& body) {
    body.set_loads(traction_loads(body.mesh(), body.mesh().boundary("end"), Point<3>{1e3, 0, 0}));
  }

  /// Lines lie closer together towards the planes of the notch.
  static auto graded(int n) {
    auto const towards = [](double s, double at) {
      double const width = s < at ? at : 1 - at;
      return at + std::copysign(width * std::pow(std::abs(s - at) / width, 4), s - at);
    };
    return mesh<Hex27>(n, [=](Point<3> const& p) {
      return Point<3>{2 * towards(p[0], 0.25), towards(p[1], 0.5), towards(p[2], 0.5)};
    });
  }
  /// J. Meshes of n = 6, 8, 10 and 12 have 11.524030, 11.527930, 11.529380 and 11.530035, whose differences fall as n⁻²·⁹.
  static constexpr double reference = 11.53097;
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
    print_energies<NotchedBlock>({6, 8, 10, 12});
  else
    compare_solids<NotchedBlock>(options);
}
