#include "verification/support/grading.hpp"
#include "work_precision/mesh_contest.hpp"
#include "work_precision/reference_energy.hpp"

// A beam that hangs from its top, and one that is clamped at its left end, under their weight.
namespace pliant::bench {

struct Hanging {
  static constexpr char const* name = "hanging beam";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.003;
  template <class S>
  using law = Hooke<S>;

  static Elastic material() { return {.young = 2e6, .poisson = 0.3, .density = 1e3}; }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return mesh::rectangle<E>({.size = {1, 4}, .cells = {n, 4 * n}});
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.clamp(body.mesh().boundary("top"));
    body.set_gravity({0, -10});
  }
  template <class TheBody>
  static void load(TheBody&) {}

  /// Finer towards the corners at the top.
  static auto graded(int n) {
    auto mesh = verification::graded<Quad9>({n, n}, verification::towards_ends(4),
                                            [](double s) { return 1 - std::pow(1 - s, 4); });
    for (auto& p : mesh.nodes) p[1] *= 4;
    return mesh;
  }
  inline static double reference = 0;
  template <Element... Es, class TheBody>
  static double error(TheBody const&, NewtonReport const& report) {
    return error_of(report.energy, reference);
  }
};

/// A cantilever.
struct Cantilever {
  static constexpr char const* name = "cantilever";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.005;
  template <class S>
  using law = Hooke<S>;

  static Elastic material() { return {.young = 2e6, .poisson = 0.3, .density = 1e3}; }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return mesh::rectangle<E>({.size = {4, 1}, .cells = {4 * n, n}});
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -10});
  }
  template <class TheBody>
  static void load(TheBody&) {}

  /// Finer towards the corners at the left.
  static auto graded(int n) {
    auto mesh = verification::graded<Quad9>({n, n}, verification::towards_start(4),
                                            verification::towards_ends(4));
    for (auto& p : mesh.nodes) p[0] *= 4;
    return mesh;
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
  find_reference<Hanging>();
  compare_meshes<Hanging>(options);
  find_reference<Cantilever>();
  compare_meshes<Cantilever>(options);
}
