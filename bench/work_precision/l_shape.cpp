#include "verification/support/l_shape.hpp"

#include "work_precision/energy_error.hpp"
#include "work_precision/mesh_contest.hpp"

// The L-shape of REFERENCES, section 8: its exact field is singular at the re-entrant corner.
namespace pliant::bench {

struct LShape {
  static constexpr char const* name = "L-shape";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.01;
  template <class S>
  using law = Hooke<S>;

  static Elastic material() { return verification::l_shape_material; }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return verification::l_shape<E>(n, 1);
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.drive(mesh::outer_sides_where(body.mesh(), verification::on_outer_l_shape),
               [](Point<2> const& X, double) { return verification::displacement_in_l_shape(X); });
  }
  template <class TheBody>
  static void load(TheBody&) {}
  template <Element... Es, class TheBody>
  static double error(TheBody const& body, NewtonReport const&) {
    auto const law = Hooke<double>::from(material());
    double const energy =
        (energy_of_error<Es>(body, law, verification::gradient_in_l_shape, Point<2>{0, 0}) + ...);
    return std::sqrt(energy / 2.054512443695e-4);
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::compare_meshes<pliant::bench::LShape>({argc, argv});
}
