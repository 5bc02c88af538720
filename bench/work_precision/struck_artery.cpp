#include "work_precision/artery.hpp"
#include "work_precision/laws.hpp"

// Half of a piece of an artery that is struck from inside, at one side: there its fibres stretch, and take up load late, as those
// of the adventitia do. Elsewhere the matrix alone, isochoric neo-Hookean, is nearly the same law.
namespace pliant::bench {

struct StruckArtery {
  static constexpr HolzapfelGasserOgden<double> adventitia{
      .mu = 3e4, .k1 = 5e2, .k2 = 25, .dispersion = 0, .bulk = 3e5};
  static constexpr double height = 3e-3, struck = 1e-3, speed = 2;  // m, m, m/s
  static constexpr double volume = std::numbers::pi / 2 *
                                   (artery::outer * artery::outer - artery::inner * artery::inner) *
                                   height;
  /// With the moduli of the matrix.
  static constexpr Elastic material{
      .young = 9 * adventitia.bulk * adventitia.mu / (3 * adventitia.bulk + adventitia.mu),
      .poisson =
          (3 * adventitia.bulk - 2 * adventitia.mu) / (2 * (3 * adventitia.bulk + adventitia.mu)),
      .density = artery::density};
  static constexpr int samples = 60;
  static constexpr Point<3> place{artery::outer, 0, 0};

  template <Element E>
  static Mesh<E> mesh() {
    return artery::wall<E>(std::numbers::pi, height, {3, 48, 30});
  }
  template <class F, class M>
  static Group<F> group(M const&) {
    return artery::group<F>(adventitia);
  }
  template <class TheBody>
  static void begin(TheBody& body) {
    for (char const* cut : {"front", "back"}) body.hold(body.mesh().boundary(cut), 2);  // along y
    body.hold(body.mesh().boundary("bottom"), 4);                                       // along z
    body.clamp(body.mesh().boundary("top"));
    body.set_damping(500);  // 1/s
    auto v = body.velocities();
    for (std::size_t i = 0; i < v.size(); ++i) {
      auto const& p = body.mesh().nodes[i];
      double const around = std::atan2(p[1], p[0]);
      double const away = std::hypot(artery::outer * around, p[2]) / struck;
      double const radial = speed * std::max(0.0, 1 - square(away));
      v[i] = {radial * std::cos(around), radial * std::sin(around), 0};
    }
    body.set_velocities(v);
  }
};

template <Element E>
void strike(std::string const& problem, Options const& options) {
  std::string const fibres = "Holzapfel-Gasser-Ogden", matrix = "isochoric neo-Hookean";
  LawContest<StruckArtery, E, HolzapfelGasserOgden> contest(options, fibres);
  contest.template add_plain<double, IsochoricNeoHookean>(matrix);
  contest.template add_plain<double, HolzapfelGasserOgden>(fibres);
  contest.template add_plain<float, HolzapfelGasserOgden>(fibres + ", float");
  for (double above : {0.005, 0.02, 0.05, 0.1})
    contest.template add_adaptive<IsochoricNeoHookean>(matrix, StrainNorm{}, above);
  for (double above : {0.005, 0.02, 0.05, 0.1})
    contest.template add_cheapest<IsochoricNeoHookean>(matrix, above);
  contest.hold(problem + ", " + fibres, options);
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  bench::Options const options(argc, argv);
  bench::strike<Hex8>("struck artery, Hex8", options);
  bench::strike<Tet4>("struck artery, Tet4", options);
}
