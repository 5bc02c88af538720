#include "work_precision/artery.hpp"
#include "work_precision/energy_error.hpp"
#include "work_precision/mesh_contest.hpp"

// A ring of an artery under the pressure of blood; a quarter of it. It widens as the radial equation of equilibrium says, which has
// one unknown function of the radius and is integrated beforehand.
namespace pliant::bench {

namespace artery {

/// The matrix is nearly incompressible: ν = 0.495.
inline constexpr HolzapfelGasserOgden<double> media{
    .mu = 3e3, .k1 = 2.3632e3, .k2 = 0.8393, .dispersion = 0, .bulk = 3e5};

/// r(R) of a wall that keeps its length: dS/dR = (P_θθ − S)/R with the radial stress S = P_RR(dr/dR, r/R), from the outer side, where
/// S = 0, inwards; by the Runge-Kutta method.
class Widening {
 public:
  /// Whose outer side is stretched so far.
  explicit Widening(double stretch) {
    for (double direction : {1.0, -1.0}) {
      State state{stretch * outer, 0};
      double radius = outer;
      std::vector<Place> found;
      for (int k = 0; k <= (direction > 0 ? margin : margin + steps); ++k) {
        found.push_back({state.r, slope(state, radius)});
        state = next(state, radius, direction * step);
        radius += direction * step;
      }
      if (direction > 0)
        places_.assign(found.rbegin(), found.rend() - 1);
      else
        places_.insert(places_.end(), found.begin(), found.end());
    }
    std::ranges::reverse(places_);  // radii go up from inner − margin · step
    State state{stretch * outer, 0};
    for (int k = 0; k < steps; ++k) state = next(state, outer - k * step, -step);
    pressure_ = -state.stress * inner / state.r;
  }
  double pressure() const { return pressure_; }  // Pa

  /// r and dr/dR, by cubics.
  std::pair<double, double> at(double radius) const {
    double const s = (radius - inner) / step + margin;
    auto const k = static_cast<std::size_t>(
        std::clamp(std::floor(s), 0.0, static_cast<double>(places_.size() - 2)));
    double const t = s - static_cast<double>(k);
    auto const &a = places_[k], &b = places_[k + 1];
    double const rise = (b.r - a.r) / step, bend = a.slope + b.slope - 2 * rise;
    return {a.r + step * t * (a.slope + t * (3 * rise - 2 * a.slope - b.slope + t * bend)),
            a.slope + t * (2 * (3 * rise - 2 * a.slope - b.slope) + 3 * t * bend)};
  }
  Point<3> displacement(Point<3> const& X) const {
    double const radius = std::hypot(X[0], X[1]), grown = at(radius).first / radius - 1;
    return {grown * X[0], grown * X[1], 0};
  }
  Tensor<double, 3> gradient(Point<3> const& X) const {
    double const radius = std::hypot(X[0], X[1]);
    auto const [r, radial] = at(radius);
    double const n[2] = {X[0] / radius, X[1] / radius};
    auto h = Tensor<double, 3>::zero();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) h(i, j) = (radial - r / radius) * n[i] * n[j];
      h(i, i) += r / radius - 1;
    }
    return h;
  }

 private:
  struct State {
    double r, stress;
  };
  struct Place {
    double r, slope;
  };
  static constexpr int steps = 2000, margin = 200;
  static constexpr double step = (outer - inner) / steps;

  /// Radial and circumferential.
  static std::pair<double, double> stresses(double radial, double around) {
    auto h = Tensor<double, 3>::zero();
    h(0, 0) = radial - 1;
    h(1, 1) = around - 1;
    Vector<double, 6> directions;
    auto const fibres = fibres_at({1, 0, 0});
    for (int k = 0; k < 6; ++k) directions[k] = fibres[static_cast<std::size_t>(k)];
    auto const p = stress(media.at(directions), h);
    return {p(0, 0), p(1, 1)};
  }
  /// dr/dR, by Newton's method with a difference quotient.
  static double slope(State const& state, double radius) {
    double radial = radius / state.r;
    for (int k = 0; k < 50; ++k) {
      double const off = stresses(radial, state.r / radius).first - state.stress;
      double const by = 1e-6;
      double const rises = (stresses(radial + by, state.r / radius).first -
                            stresses(radial - by, state.r / radius).first) /
                           (2 * by);
      radial -= off / rises;
      if (std::abs(off / rises) < 1e-14) break;
    }
    return radial;
  }
  static State rate(State const& state, double radius) {
    double const radial = slope(state, radius);
    return {radial, (stresses(radial, state.r / radius).second - state.stress) / radius};
  }
  static State next(State const& s, double radius, double h) {
    auto const along = [&](State const& rate, double share) {
      return State{s.r + share * h * rate.r, s.stress + share * h * rate.stress};
    };
    auto const a = rate(s, radius), b = rate(along(a, 0.5), radius + h / 2),
               c = rate(along(b, 0.5), radius + h / 2), d = rate(along(c, 1), radius + h);
    return {s.r + h / 6 * (a.r + 2 * b.r + 2 * c.r + d.r),
            s.stress + h / 6 * (a.stress + 2 * b.stress + 2 * c.stress + d.stress)};
  }

  std::vector<Place> places_;
  double pressure_ = 0;
};

}  // namespace artery

struct ArteryRing {
  static constexpr char const* name = "artery ring";
  static constexpr int coarse = 2;
  static constexpr double enough = 0.005;
  static constexpr long most_unknowns = 12000;
  template <class S>
  using law = HolzapfelGasserOgden<S>;

  inline static artery::Widening const widening{1.2};

  static Elastic material() { return {.young = 9e3, .poisson = 0.495, .density = artery::density}; }
  template <Element E>
  static Mesh<E> mesh(int n) {
    return artery::wall<E>(std::numbers::pi / 2, 0.2e-3, {n, 4 * n, n / 2});
  }
  template <class F, class M>
  static Group<F> group(M const&) {
    return artery::group<F>(artery::media);
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.hold(body.mesh().boundary("front"), 2);  // along y
    body.hold(body.mesh().boundary("back"), 1);   // along x
    for (char const* end : {"bottom", "top"}) body.hold(body.mesh().boundary(end), 4);
    body.press(body.mesh().boundary("left"), widening.pressure());
  }
  template <class TheBody>
  static void load(TheBody&) {}
  template <Element... Es, class TheBody>
  static double error(TheBody const& body, NewtonReport const&) {
    return error_of_gradient<Es...>(body, [](Point<3> const& X) { return widening.gradient(X); });
  }
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::bench;
  Options const options(argc, argv);
  std::vector<Contestant> contestants;
  add_elements<ArteryRing, Tet4, Hex8, Tet10, Hex20, Hex27>(contestants, options);
  auto const under = [&]<class E, class Q>(E, Q, std::string const& name) {
    add_uniform<ArteryRing, Formulation<E, Q, HolzapfelGasserOgden>>(
        contestants, options, std::string(E::name()) + ", uniform, " + name);
  };
  under(Hex8{}, FBar<Gauss<2>>{}, "FBar");
  under(Tet10{}, FBar<Gauss<3>>{}, "FBar");
  under(Hex27{}, FBar<Gauss<3>>{}, "FBar");
  add_rules<ArteryRing, Hex8>(contestants, options, {0.65});
  hold_contest(ArteryRing::name, contestants, options);
}
