#include <numbers>

#include "work_precision/laws.hpp"

// A bar that is clamped at one end and let go while it turns about its axis (REFERENCES, section 7, more gently). Strains are large at
// the clamped end and the sides, small in the core and at the free end.
namespace pliant::bench {

struct TwistingBar {
  static constexpr double length = 4, spin = 20;  // m, rad/s at the free end
  static constexpr double volume = length;
  static constexpr Elastic material{.young = 3e6, .poisson = 0.3, .density = 1e3};
  static constexpr int samples = 60;
  static constexpr Point<3> place{length, 0.5, 0.5};

  template <Element E>
  static Mesh<E> mesh() {
    return mesh::box<E>({.size = {length, 1, 1}, .cells = {24, 6, 6}, .origin = {0, -0.5, -0.5}});
  }
  template <class TheBody>
  static void begin(TheBody& body) {
    body.clamp(body.mesh().boundary("left"));
    auto v = body.velocities();
    for (std::size_t i = 0; i < v.size(); ++i) {
      auto const& p = body.mesh().nodes[i];
      double const rate = spin * std::sin(std::numbers::pi / 2 * p[0] / length);
      v[i] = {0, -rate * p[2], rate * p[1]};
    }
    body.set_velocities(v);
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  bench::compare_ogden<bench::TwistingBar, Hex8>("twisting bar, Hex8, Ogden", {argc, argv});
}
