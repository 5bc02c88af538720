#include "stability/cases.hpp"

#include <cmath>

#include "support/random.hpp"

namespace pliant::stability {
namespace {

/// Cells along an edge of a body of unit size.
int cells_of(Bodies const& bodies) {
  if (bodies.dim == 2) return bodies.degree == 1 ? 6 : 3;
  return bodies.degree == 1 ? 3 : 2;
}

/// A number from a place, in [0, 1), the same wherever it is asked.
double scattered(Vec const& X, unsigned salt) {
  auto const h = std::sin(12.9898 * X[0] + 78.233 * X[1] + 37.719 * X[2] + salt) * 43758.5453;
  return h - std::floor(h);
}

Vec minus(Vec const& a, Vec const& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

class Maker {
 public:
  Maker(bool quick, Bodies const& bodies, Bodies const& reference)
      : quick_(quick), bodies_(bodies), reference_(reference) {
    middle_ = bodies.dim == 2 ? Vec{0.5, 0.5, 0} : Vec{0.5, 0.5, 0.5};
  }

  std::vector<Case> all() {
    for (auto const& law : bodies_.laws)
      for (auto const method : all_methods) {
        law_ = law;
        method_ = method;
        for_law_and_method();
      }
    return std::move(cases_);
  }
  /// Of special_bodies.
  std::vector<Case> all_special() {
    for (auto const method : all_methods) {
      method_ = method;
      law_ = bodies_.laws[0];
      if (method_ == Method::backward_euler) continue;
      if (!statics()) {
        for (auto const toggle : all_toggles) toggled(toggle);
        compressed(Toggle::protective);
      }
      compressed(Toggle::none);
      law_ = bodies_.laws[1];
      if (!statics()) toggled(Toggle::mesh);
      law_ = bodies_.laws[2];
      hard_and_soft();
    }
    return std::move(cases_);
  }

 private:
  bool statics() const { return method_ == Method::statics; }
  bool implicit() const { return method_ == Method::implicit_steps; }
  bool is_explicit() const {
    return method_ == Method::explicit_steps || method_ == Method::local_steps;
  }

  Scene scene() const {
    Scene s;
    int const n = cells_of(bodies_);
    s.cells = {n, n, n};
    s.law = law_.name;
    s.method = method_;
    return s;
  }
  void add(std::string name, std::string variant, Scene s, Demands demands) {
    if (s.method == Method::statics && demands.close) {
      demands.close = false;
      demands.rest = true;
    }
    cases_.push_back(
        {std::move(name), std::move(variant), std::move(s), demands, &bodies_, &reference_});
  }
  static std::string printed(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
  }

  /// Steps whose trajectories are compared: those of smooth motions half the stable one, those of sudden ones a tenth.
  void take_steps(Scene& s, double of_stable, int steps) const {
    s.safety = of_stable;
    if (implicit()) s.stable_steps = of_stable / 2;
    s.steps = implicit() ? steps / (quick_ ? 3 : 2) : steps;
  }
  /// Close to the reference; or else, as motions that buckle or fold follow the smallest disturbance, with the energy
  /// kept. Implicit steps keep that of small motions alone: it must not grow.
  Demands close_or_kept() const {
    if (implicit()) return {.close = true, .or_growth = 0.02};
    return {.close = true, .or_drift = 0.02};
  }

  void for_law_and_method() {
    if (method_ == Method::backward_euler) return long_steps();
    sag();
    spin();
    turned();
    for (double const stretch : {0.05, 0.3, 0.7, 1.5, 3.0, 10.0}) stretched(stretch);
    broken("scrambled");
    broken("flattened");
    broken("collapsed");
    broken("inverted");
    for (double const speed : {2.0, 20.0}) impact(speed);
    collision(10);
    collision(60);
    let_go();
    for (double const factor : {0.0, 2.0, 10.0, 100.0, 1e9}) absurd(factor);
    for (double const poisson : {0.0, 0.45, 0.49, 0.499, 0.49999}) incompressible(poisson);
    slivers();
    graded();
    snap();
    for (double const share : {0.1, 1.0, 10.0}) pressed(share);
    reversed();
    poisoned();
  }

  /// A hundred times the stable step.
  void long_steps() {
    auto s = scene();
    s.held = {"left"};
    s.gravity = {0, -50, 0};
    s.stable_steps = 100;
    s.steps = 120;
    add("long steps", "sag", s, {.growth = 1e-3, .calm = true});
    s.gravity = {};
    s.velocity = [](Vec const& X) -> Vec { return {0, 20 * X[0] * X[0], 5 * X[0]}; };
    add("long steps", "thrown", s, {.growth = 1e-3, .calm = true});
  }

  void sag() {
    auto s = scene();
    s.held = {"left"};
    s.gravity = {0, -50, 0};
    take_steps(s, 0.5, 60);
    add("sag", "", s, {.close = true});
  }

  void spin() {
    if (statics()) return;
    auto s = scene();
    double const rate = 20;
    Vec const axis = bodies_.dim == 2 ? Vec{0, 0, 1} : Vec{0.6, 0, 0.8};
    s.velocity = [=, middle = middle_](Vec const& X) -> Vec {
      Vec const r = minus(X, middle);
      return {rate * (axis[1] * r[2] - axis[2] * r[1]), rate * (axis[2] * r[0] - axis[0] * r[2]),
              rate * (axis[0] * r[1] - axis[1] * r[0])};
    };
    s.steps = implicit() ? 100 : quick_ ? 500 : 5000;
    if (implicit()) s.stable_steps = 1;
    s.safety = 0.5;
    Demands demands{.drift = 0.02, .momentum = true, .spin = law_.objective && is_explicit()};
    if (implicit()) demands = {.growth = 0.02, .momentum = true};
    add("free spin", "", s, demands);
    bool const long_too = law_.name == "SaintVenantKirchhoff" || law_.name == "NeoHookean";
    if (quick_ || implicit() || bodies_.degree > 1 || !long_too) return;
    s.cells = {2, 2, 2};
    s.steps = 1000000;
    add("free spin", "1e6 steps", s, demands);
  }

  void turned() {
    auto s = scene();
    double const angle = 2.1, c = std::cos(angle), sn = std::sin(angle);
    s.displacement = [=, middle = middle_](Vec const& X) -> Vec {
      Vec const r = minus(X, middle);
      return {c * r[0] - sn * r[1] - r[0], sn * r[0] + c * r[1] - r[1], 0};
    };
    if (statics()) {
      s.held = {"left"};
      s.gravity = {0, -50, 0};
      add("turned", "", s, {.rest = true});
      return;
    }
    take_steps(s, 0.1, 100);
    add("turned", "", s, law_.objective ? Demands{.still = true} : close_or_kept());
  }

  void stretched(double stretch) {
    auto s = scene();
    if (statics()) {
      s.held = {"left"};
      s.driven = "right";
      s.motion = [=](Vec const&, double) -> Vec { return {stretch - 1, 0, 0}; };
      s.load_steps = 10;
    } else {
      s.held = {"left", "right"};
      s.displacement = [=](Vec const& X) -> Vec { return {(stretch - 1) * X[0], 0, 0}; };
      take_steps(s, 0.1, 100);
    }
    add("stretch", printed(stretch), s, close_or_kept());
  }

  /// Free bodies whose elements are flat or inverted; in statics, one side stays at rest.
  void broken(std::string const& how) {
    auto s = scene();
    bool const keep = statics();
    double const cell = 1.0 / s.cells[0];
    int const dim = bodies_.dim;
    s.displacement = [=, middle = middle_](Vec const& X) -> Vec {
      if (keep && X[0] < 1e-9) return {};
      if (how == "flattened") return {0, -X[1], 0};
      if (how == "collapsed") return minus(middle, X);
      if (how == "scrambled") {
        Vec const to{scattered(X, 1), scattered(X, 2), dim == 2 ? 0 : scattered(X, 3)};
        return minus(to, X);
      }
      // One node through its neighbours.
      double const far = std::hypot(X[0] - 1, X[1] - 1, dim == 2 ? 0 : X[2] - 1);
      return far < 1e-9 ? Vec{-1.6 * cell, -1.6 * cell, dim == 2 ? 0 : -1.6 * cell} : Vec{};
    };
    if (statics()) {
      s.held = {"left"};
      add(how, "", s, {.rest = true});
      return;
    }
    s.damping = 50;
    s.steps = implicit() ? 60 : 3000;
    if (implicit()) s.stable_steps = 1;
    Demands demands{.growth = 0.05};
    if (is_explicit() && how != "collapsed") demands.calm = true;
    add(how, "", s, demands);
  }

  void impact(double speed) {
    if (statics()) return;
    auto s = scene();
    s.held = {"left"};
    s.velocity = [=](Vec const& X) -> Vec { return {X[0] > 1e-9 ? -speed : 0, 0, 0}; };
    s.duration = 0.06;
    s.safety = 0.5;
    if (implicit()) s.stable_steps = 0.5;
    add("impact", printed(speed) + " m/s", s,
        is_explicit() ? Demands{.drift = 0.05} : Demands{.growth = 0.05});
  }

  /// The halves of a free body fly against each other.
  void collision(double speed) {
    if (statics()) return;
    auto s = scene();
    s.velocity = [=](Vec const& X) -> Vec {
      return {speed * (0.5 - X[0]), 0.1 * speed * X[0] * X[1], 0};
    };
    s.duration = 0.06;
    s.safety = 0.5;
    if (implicit()) s.stable_steps = 0.5;
    Demands demands{.drift = 0.05, .momentum = true, .spin = law_.objective};
    if (implicit()) demands = {.growth = 0.05, .momentum = true};
    add("collision of halves", printed(speed) + " m/s", s, demands);
  }

  /// Let go, with damping; in statics solved from there.
  void let_go() {
    auto s = scene();
    s.held = {"left"};
    s.displacement = [](Vec const& X) -> Vec { return {0.4 * X[0] * X[0], 0.3 * X[0] * X[0], 0}; };
    s.damping = 40;
    s.duration = 0.8;
    if (implicit()) s.stable_steps = 2;
    add("return to rest", "", s,
        statics() ? Demands{.returns = true, .rest = true}
                  : Demands{.growth = 0.02, .returns = true});
  }

  /// Steps of so many times the stable one; 0: of 1e-12 of it.
  void absurd(double factor) {
    if (statics()) return;
    auto s = scene();
    s.held = {"left"};
    s.gravity = {0, -50, 0};
    s.stable_steps = factor > 0 ? factor : 1e-12;
    s.steps = implicit() ? 20 : method_ == Method::local_steps ? 100 : 600;
    add("absurd step", printed(s.stable_steps), s, {.growth = 0.05});
  }

  void incompressible(double poisson) {
    bool const other =
        law_.name != "Hooke" && law_.name != "SaintVenantKirchhoff" && law_.name != "NeoHookean";
    if (other) return;  // for the time that it takes
    for (int const cells : {2, 4, 8}) {
      if (quick_ && (cells != 4 || poisson == 0.45 || poisson == 0.499)) continue;
      if (bodies_.dim == 3 && cells > 4) continue;
      if (bodies_.degree > 1 && cells > 4) continue;
      for (double const step : {0.25, 0.5}) {
        if ((statics() || quick_) && step < 0.5) continue;
        auto s = scene();
        s.cells = {cells, cells, cells};
        s.material.poisson = poisson;
        s.held = {"left"};
        s.gravity = {0, -50, 0};
        s.load_steps = 4;
        take_steps(s, step, 40);
        add("Poisson's ratio",
            printed(poisson) + ", " + printed(cells) + " cells, step " + printed(step), s,
            {.close = true});
      }
    }
  }

  void slivers() {
    auto s = scene();
    (bodies_.dim == 2 ? s.size[1] : s.size[2]) = 0.005;
    s.held = {"left"};
    s.gravity = {-50, 0, 0};
    take_steps(s, 0.5, 60);
    add("slivers", "", s, {.close = true});
  }

  /// Neighbours of very different mass.
  void graded() {
    auto s = scene();
    int const n = s.cells[0];
    double const all = 1e6;
    s.place = [=](Vec const& X) -> Vec {
      // Widths grow by the same factor from each cell to the next, 1e6 in all.
      double const q = std::pow(all, 1.0 / (n - 1));
      return {(std::pow(q, n * X[0]) - 1) / (std::pow(q, n) - 1), X[1], X[2]};
    };
    s.held = {"left"};
    s.gravity = {-50, 0, 0};
    take_steps(s, 0.5, 60);
    add("mass ratio 1e6", "", s, {.close = true});
  }

  void snap() {
    auto s = scene();
    s.size = bodies_.dim == 2 ? Vec{1, 0.04, 0} : Vec{1, 0.04, 0.04};
    s.cells = {bodies_.degree == 1 ? 12 : 6, 1, 1};
    s.place = [](Vec const& X) -> Vec {
      return {X[0], X[1] + 0.08 * std::sin(3.14159265358979 * X[0]), X[2]};
    };
    s.held = {"left", "right"};
    s.load = {0, bodies_.dim == 2 ? -4e3 : -160.0, 0};
    s.load_at = {0.5, 0.12, 0};
    s.load_steps = 4;
    if (statics()) {
      add("snap-through", "", s, {.rest = true});
      return;
    }
    s.damping = 20;
    s.duration = 0.1;
    s.safety = 0.5;
    if (implicit()) s.stable_steps = 2;
    add("snap-through", "", s, {.growth = 0.05});
  }

  void pressed(double share) {
    auto s = scene();
    s.held = {"left"};
    s.pressed = "right";
    s.pressure = share * s.material.young;
    s.load_steps = 10;
    take_steps(s, 0.1, 150);
    add("pressure", printed(share) + " E", s,
        implicit() ? Demands{.close = true} : close_or_kept());
  }

  void reversed() {
    auto s = scene();
    s.reversed = true;
    s.held = {"left"};
    s.gravity = {0, -50, 0};
    s.steps = 10;
    if (implicit()) s.stable_steps = 1;
    add("reversed winding", "", s, {.must_report = true});
  }

  void poisoned() {
    using enum Poison;
    constexpr std::array names{
        "rest positions", "displacements",  "velocities", "one load", "loads",
        "gravity",        "damping",        "pressure",   "motion",   "Young's modulus",
        "u of the state", "v of the state", "embedded u"};
    int k = 0;
    for (auto const where :
         {rest_positions, displacements, velocities, one_load, loads, gravity, damping, pressure,
          motion, young, state_of_displacements, state_of_velocities, embedded_displacements}) {
      std::string const name = names[static_cast<std::size_t>(k++)];
      if (statics() && (where == velocities || where == damping || where == state_of_velocities ||
                        where == embedded_displacements))
        continue;
      auto s = scene();
      s.poison = where;
      s.held = {"left"};
      if (where == pressure) s.pressed = "right";
      if (where == motion) {
        s.driven = "right";
        s.motion = [](Vec const&, double) -> Vec { return {0.01, 0, 0}; };
        if (statics()) continue;  // it is not a number later
      }
      s.steps = implicit() ? 4 : 600;
      if (implicit()) s.step = 1e-3;
      add("NaN", name, s, {.must_report = true});
    }
  }

  /// Changed before every step.
  void toggled(Toggle toggle) {
    auto s = scene();
    s.toggle = toggle;
    s.held = {"left"};
    s.gravity = {0, -300, 0};
    take_steps(s, 0.25, 300);
    s.samples = s.steps;
    add("toggled every step", name_of(toggle), s, close_or_kept());
  }

  /// Far below 0.58, where Saint Venant-Kirchhoff's law softens.
  void compressed(Toggle toggle) {
    auto s = scene();
    s.toggle = toggle;
    s.held = {"left"};
    s.driven = "right";
    if (statics()) {
      s.motion = [](Vec const&, double) -> Vec { return {-0.6, 0, 0}; };
      s.load_steps = 20;
    } else {
      s.motion = [](Vec const&, double t) -> Vec {
        double const share = std::min(t / 0.2, 1.0);
        return {-0.6 * share * share * (3 - 2 * share), 0, 0};
      };
    }
    s.duration = 0.2;
    s.samples = 100;
    s.safety = 0.1;
    if (implicit()) s.stable_steps = 0.1;
    auto demands = close_or_kept();
    demands.unfolded = toggle == Toggle::protective;
    add("compression to 0.4", toggle == Toggle::none ? "unprotected" : "switched at 0.85", s,
        demands);
  }

  void hard_and_soft() {
    auto s = scene();
    s.held = {"left"};
    s.gravity = {0, -50, 0};
    take_steps(s, 0.5, 60);
    add("stiffness ratio 1e6", "", s, {.close = true});
  }

  bool quick_;
  Bodies const &bodies_, &reference_;
  Vec middle_;
  LawInfo law_{};
  Method method_{};
  std::vector<Case> cases_;
};

}  // namespace

std::vector<Case> all_cases(bool quick) {
  std::vector<Case> cases;
  auto const add = [&](std::vector<Bodies> const& list, auto const& make) {
    for (auto const& bodies : list)
      for (auto const& reference : list)
        if (reference.reference && reference.element == bodies.element)
          for (auto& one : make(Maker(quick, bodies, reference))) cases.push_back(std::move(one));
  };
  add(all_bodies(), [](Maker&& maker) { return maker.all(); });
  add(special_bodies(), [](Maker&& maker) { return maker.all_special(); });
  return cases;
}

}  // namespace pliant::stability
