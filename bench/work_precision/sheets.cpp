#include <pliant/mesh/loads.hpp>

#include "scene/carve.hpp"
#include "verification/support/grading.hpp"
#include "work_precision/mesh_contest.hpp"
#include "work_precision/reference_energy.hpp"

// Sheets that no rule for meshes was chosen by: Cook's membrane, a plate with a square hole.
namespace pliant::bench {

template <class TheBody>
void pull_right_side(TheBody& body, Point<2> const& traction) {
  body.set_loads(traction_loads(body.mesh(), body.mesh().boundary("right"), traction));
}

/// REFERENCES, section 3: plane stress, E = 1 Pa, ν = 1/3.
struct Cook {
  static constexpr char const* name = "Cook's membrane";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.01;
  template <class S>
  using law = PlaneStress<Hooke>::law<S>;

  static Elastic material() { return {.young = 1, .poisson = 1.0 / 3, .density = 1}; }
  template <class M>
  static M shaped(M mesh) {
    for (auto& p : mesh.nodes) p = {48 * p[0], 44 * (p[0] + p[1]) - 28 * p[0] * p[1]};
    return mesh;
  }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return shaped(mesh::rectangle<E>({.size = {1, 1}, .cells = {n, n}}));
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.clamp(body.mesh().boundary("left"));
  }
  template <class TheBody>
  static void load(TheBody& body) {
    pull_right_side(body, {0, 1.0 / 16});
  }

  static auto graded(int n) {
    return shaped(verification::graded<Quad9>({n, n}, verification::towards_ends(3),
                                              verification::towards_ends(3)));
  }
  inline static double reference = 0;
  template <Element... Es, class TheBody>
  static double error(TheBody const&, NewtonReport const& report) {
    return error_of(report.energy, reference);
  }
};

/// A quarter of a plate with a square hole half as wide, pulled at its ends.
struct SquareHole {
  static constexpr char const* name = "plate with a square hole";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.005;
  template <class S>
  using law = Hooke<S>;

  static Elastic material() { return {.young = 1e5, .poisson = 0.3, .density = 1}; }

  /// [0, 2]² without [0, 1]², from a square of n × n cells whose lines lie where `place` puts them.
  template <Element E, class Place>
  static Mesh<E> mesh(int n, Place const& place) {
    using Linear = verification::LinearOn<E>;
    auto plate = scene::carve(mesh::rectangle<Linear>({.size = {2, 2}, .cells = {n, n}}),
                              [](Point<2> const& p) { return p[0] < 1 && p[1] < 1; });
    for (auto& p : plate.nodes) p = {place(p[0]), place(p[1])};
    auto const side = [&](std::size_t k, double at) {
      return mesh::outer_sides_where(plate,
                                     [=](Point<2> const& p) { return std::abs(p[k] - at) < 1e-9; });
    };
    plate.boundaries = {{"left", side(0, 0)}, {"bottom", side(1, 0)}, {"right", side(0, 2)}};
    if constexpr (E::degree > 1)
      return mesh::raised<E>(plate);
    else
      return plate;
  }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return mesh<E>(n, [](double x) { return x; });
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.hold(body.mesh().boundary("left"), 1);    // along x
    body.hold(body.mesh().boundary("bottom"), 2);  // along y
  }
  template <class TheBody>
  static void load(TheBody& body) {
    pull_right_side(body, {1e3, 0});
  }

  static auto graded(int n) {
    return mesh<Quad9>(
        n, [](double x) { return 1 + std::copysign(std::pow(std::abs(x - 1), 4.5), x - 1); });
  }
  inline static double reference = 0;
  template <Element... Es, class TheBody>
  static double error(TheBody const&, NewtonReport const& report) {
    return error_of(report.energy, reference);
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant::bench;
  Options const options(argc, argv);
  find_reference<Cook>();
  compare_meshes<Cook>(options);
  find_reference<SquareHole>();
  compare_meshes<SquareHole>(options);
}
