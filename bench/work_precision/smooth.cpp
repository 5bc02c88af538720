#include "verification/support/manufactured.hpp"
#include "work_precision/energy_error.hpp"
#include "work_precision/mesh_contest.hpp"

// A smooth field at finite strain (REFERENCES, section 9), where no place needs more elements than another.
namespace pliant::bench {

struct Smooth {
  static constexpr char const* name = "smooth field, finite strain";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.01;
  template <class S>
  using law = SaintVenantKirchhoff<S>;

  /// λ = 1.5 Pa, μ = 1 Pa.
  static Elastic material() { return {.young = 2.6, .poisson = 0.3, .density = 1}; }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return mesh::rectangle<E>({.size = {1, 1}, .cells = {n, n}});
  }
  static Point<2> displacement(Point<2> const& X, double) {
    auto const u = verification::exact_at<2>(X).u;
    return {u[0], u[1]};
  }
  static Tensor<double, 2> gradient(Point<2> const& X) {
    return verification::exact_at<2>(X).gradient;
  }

  template <class TheBody>
  static void hold(TheBody& body) {
    body.drive(mesh::outer_sides(body.mesh()), displacement);
  }
  template <class TheBody>
  static void load(TheBody& body) {
    body.set_loads(body_loads(body.mesh(), [](Point<2> const& X) {
      return verification::force_needed<SaintVenantKirchhoff, 2>(X);
    }));
  }
  template <Element... Es, class TheBody>
  static double error(TheBody const& body, NewtonReport const& report) {
    auto const law = SaintVenantKirchhoff<double>::from(material());
    return std::sqrt((energy_of_error<Es>(body, law, gradient, {}) + ...) / report.energy);
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::bench;
  Options const options(argc, argv);
  std::vector<Contestant> one_point;
  add_uniform<Smooth, Formulation<Quad4, OnePoint, SaintVenantKirchhoff>>(
      one_point, options, "Quad4, uniform, OnePoint");
  compare_meshes<Smooth>(options, one_point);
}
