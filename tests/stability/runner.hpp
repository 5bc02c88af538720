#pragma once

#include <Eigen/Cholesky>

#include <pliant/mesh/box.hpp>
#include <pliant/mesh/rectangle.hpp>
#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>
#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#elif defined(_OPENMP)
#include <pliant/openmp.hpp>
#endif

#include "stability/integrators.hpp"
#include "support/meshes.hpp"

// A scene on a body of one element with all laws, each a group.
namespace pliant::stability {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

template <int Dim>
Vec lifted(Point<Dim> const& p) {
  Vec v{};
  for (std::size_t k = 0; k < Dim; ++k) v[k] = p[k];
  return v;
}
template <int Dim>
Point<Dim> lowered(Vec const& v) {
  Point<Dim> p;
  for (std::size_t k = 0; k < Dim; ++k) p[k] = v[k];
  return p;
}

/// Puts NaN into an array, wherever it is.
template <class T>
struct Poke {
  T* place;
  PLIANT_HOST_DEVICE void operator()(Index) const { *place = std::numeric_limits<T>::quiet_NaN(); }
};

template <Element E>
Mesh<E> mesh_of(Scene const& scene) {
  using Linear = test::LinearOf<E>;
  Mesh<Linear> mesh;
  if constexpr (E::dim == 2)
    mesh = mesh::rectangle<Linear>(
        {.size = {scene.size[0], scene.size[1]}, .cells = {scene.cells[0], scene.cells[1]}});
  else
    mesh = mesh::box<Linear>({.size = scene.size, .cells = scene.cells});
  if (scene.place)
    for (auto& node : mesh.nodes) node = lowered<E::dim>(scene.place(lifted<E::dim>(node)));
  if (scene.reversed)
    for (auto& element : mesh.template elements<Linear>()) std::swap(element[0], element[1]);
  if (scene.poison == Poison::rest_positions) mesh.nodes[mesh.nodes.size() / 2][0] = not_a_number;
  if constexpr (std::same_as<E, Linear>)
    return mesh;
  else
    return mesh::raised<E>(mesh);
}

template <class TheBody>
class Run {
 public:
  static constexpr int dim = TheBody::dim;
  using Points = std::vector<Point<dim>>;

  /// `between(k)` is called before the stretch to sample k.
  Run(TheBody& body, Scene const& scene, Record& record, std::function<void(int)> between)
      : body_(body), scene_(scene), record_(record), between_(std::move(between)) {}

  void prepare() {
    auto const& mesh = body_.mesh();
    for (auto const& name : scene_.held) fixed_ = joined(fixed_, body_, name, scene_);
    if (scene_.displacement) body_.set_displacements(field(scene_.displacement));
    for (auto const& name : scene_.held) body_.clamp(mesh.boundary(name));
    if (!scene_.driven.empty()) {
      fixed_ = joined(fixed_, body_, scene_.driven, scene_);
      auto const motion = scene_.motion;
      bool const poisoned = scene_.poison == Poison::motion;
      body_.drive(mesh.boundary(scene_.driven), [=](Point<dim> const& X, double t) {
        auto u = lowered<dim>(motion(lifted<dim>(X), t));
        if (poisoned && t > 0) u[0] = not_a_number;
        return u;
      });
    }
    auto gravity = lowered<dim>(scene_.gravity);
    if (scene_.poison == Poison::gravity) gravity[0] = not_a_number;
    body_.set_gravity(gravity);
    if (scene_.damping > 0 || scene_.poison == Poison::damping)
      body_.set_damping(scene_.poison == Poison::damping ? not_a_number : scene_.damping);
    if (scene_.load != Vec{} || scene_.poison == Poison::one_load) {
      auto load = lowered<dim>(scene_.load);
      if (scene_.poison == Poison::one_load) load[0] = not_a_number;
      body_.set_load(nearest(scene_.load_at), load);
    }
    if (scene_.poison == Poison::loads) {
      Points loads(mesh.nodes.size());
      loads.back()[0] = not_a_number;
      body_.set_loads(loads);
    }
    if (!scene_.pressed.empty())
      body_.press(mesh.boundary(scene_.pressed),
                  scene_.poison == Poison::pressure ? not_a_number : scene_.pressure);
    if (scene_.velocity) body_.set_velocities(field(scene_.velocity));
    if (scene_.poison == Poison::displacements || scene_.poison == Poison::velocities) {
      Points points(mesh.nodes.size());
      points[points.size() / 2][0] = not_a_number;
      if (scene_.poison == Poison::displacements)
        body_.set_displacements(points);
      else
        body_.set_velocities(points);
    }
    // What no setter lets through: arrays that a simulator writes itself.
    auto& state = body_.parts().state;
    using T = typename TheBody::scalar;
    auto const& backend = body_.backend();
    auto const free =
        static_cast<std::size_t>(body_.parts().layout.internal_of(nearest(scene_.size)));
    auto const at = std::size_t{node_stride} * free;
    if (scene_.poison == Poison::state_of_displacements)
      backend.for_each(1, Poke<T>{state.u.data() + at});
    if (scene_.poison == Poison::state_of_velocities)
      backend.for_each(1, Poke<T>{state.v.data() + at});
  }

  void go(Replay const& replay) {
    if (scene_.poison == Poison::embedded_displacements) return embed();
    if (scene_.method == Method::statics) return rest(replay.of ? replay.times : 1);
    record_.stable_step = stable();
    sample();
    if (replay.of)
      follow(replay);
    else
      advance();
  }

  void look_for_folds() {
    record_.least_J = detail::least_jacobian_at(body_.parts(), flat_displacements(), true).value;
  }

  void sample() {
    Sample s{
        .time = body_.time(), .steps = body_.steps(), .error = told_.error, .lost = told_.lost};
    auto const u = body_.displacements(), v = body_.velocities();
    auto const& mass = body_.parts().layout.mass_list();
    s.strain = strain_energy(body_);
    s.kinetic = kinetic_energy(body_);
    s.potential = potential_energy(body_);
    s.work = external_work(body_).sum() + adaptation_energy(body_);
    for (std::size_t i = 0; i < u.size(); ++i) {
      Vec const x = lifted<dim>(u[i]), w = lifted<dim>(v[i]),
                X = lifted<dim>(body_.mesh().nodes[i]);
      s.u.push_back(x);
      Vec const p{X[0] + x[0], X[1] + x[1], X[2] + x[2]};
      double const m = mass[i];
      for (std::size_t k = 0; k < 3; ++k) {
        s.in_place = s.in_place && std::isfinite(x[k]) && std::isfinite(w[k]);
        s.momentum[k] += m * w[k];
        auto const a = (k + 1) % 3, b = (k + 2) % 3;
        s.spin[k] += m * (p[a] * w[b] - p[b] * w[a]);
      }
      double const speed = std::hypot(w[0], w[1], w[2]);
      s.speed += m * speed;
      s.arm += m * speed * std::hypot(p[0], p[1], p[2]);
    }
    s.finite = s.in_place && std::isfinite(s.total());
    record_.samples.push_back(std::move(s));
  }

 private:
  static std::vector<Index> joined(std::vector<Index> nodes, TheBody const& body,
                                   std::string const& boundary, Scene const&) {
    auto const more = nodes_of(body.mesh().boundary(boundary));
    nodes.insert(nodes.end(), more.begin(), more.end());
    return nodes;
  }
  Points field(std::function<Vec(Vec const&)> const& function) const {
    Points points;
    for (auto const& X : body_.mesh().nodes)
      points.push_back(lowered<dim>(function(lifted<dim>(X))));
    return points;
  }
  Index nearest(Vec const& place) const {
    Index found = 0;
    double least = INFINITY;
    for (std::size_t i = 0; i < body_.mesh().nodes.size(); ++i) {
      Vec const X = lifted<dim>(body_.mesh().nodes[i]);
      double const apart = std::hypot(X[0] - place[0], X[1] - place[1], X[2] - place[2]);
      if (apart < least) {
        least = apart;
        found = static_cast<Index>(i);
      }
    }
    return found;
  }

  /// s, or 0 where the state has none.
  double stable() {
    try {
      return stable_step(body_);
    } catch (Error const&) {
      if (scene_.stable_steps > 0) throw;
      return 0;
    }
  }

  void count(Progress const& progress) {
    record_.step = progress.step;
    record_.rolled_back = record_.rolled_back || progress.rolled_back;
    record_.retries = std::max(record_.retries, progress.retries);
    told_ = progress;
  }
  /// Steps until done(), at a state that the integrator has looked at: what it has not is no result yet.
  template <class Done, class Take>
  void go_on(Stepper& stepper, Done const& done, Take const& take) {
    do {
      while (!done()) count(take());
    } while (!stepper.check(body_));
  }

  void advance() {
    double const step = scene_.step > 0 ? scene_.step : scene_.stable_steps * record_.stable_step;
    Stepper stepper(scene_.method, scene_.safety, step);
    for (int k = 1; k <= scene_.samples; ++k) {
      between_(k);
      if (scene_.steps > 0) {
        auto const goal = static_cast<std::int64_t>(scene_.steps) * k / scene_.samples;
        go_on(
            stepper, [&] { return body_.steps() >= goal; },
            [&] { return stepper(body_, static_cast<int>(goal - body_.steps())); });
      } else {
        double const goal = scene_.duration * k / scene_.samples * (1 - 1e-9);
        go_on(
            stepper, [&] { return body_.time() >= goal; }, [&] { return stepper(body_, 1); });
      }
      sample();
    }
  }

  /// To the same times, by steps that are the more.
  void follow(Replay const& replay) {
    auto const& samples = replay.of->samples;
    for (std::size_t k = 1; k < samples.size(); ++k) {
      double const length = samples[k].time - body_.time();
      auto const least =
          scene_.method == Method::local_steps && record_.stable_step > 0
              ? static_cast<std::int64_t>(std::ceil(length / (0.2 * record_.stable_step)))
              : 1;
      auto const steps = std::max(least, replay.times * (samples[k].steps - samples[k - 1].steps));
      if (!(length > 0)) break;
      between_(static_cast<int>(k));
      // Local steps at a quarter are steps of the finest element.
      auto const method =
          scene_.method == Method::local_steps ? Method::explicit_steps : scene_.method;
      Stepper stepper(method, 0.9, length / static_cast<double>(steps), true);
      int ahead = static_cast<int>(steps);
      double const goal = samples[k].time * (1 - 1e-9);
      go_on(
          stepper, [&] { return body_.time() >= goal; },
          [&] { return stepper(body_, std::exchange(ahead, 1)); });
      sample();
    }
  }

  void rest(int times) {
    sample();
    record_.samples[0].finite = true;  // wherever it starts
    record_.least_J = solve_for_rest(body_, scene_.load_steps * times);
    sample();
    judge_equilibrium();
  }

  Eigen::VectorXd flat_displacements() const {
    auto const u = body_.displacements();
    Eigen::VectorXd flat(static_cast<Eigen::Index>(dim * u.size()));
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k) flat[static_cast<Eigen::Index>(dim * i + k)] = u[i][k];
    return flat;
  }

  /// By other means than Newton's method: forces on all nodes, and the inertia of the stiffness.
  void judge_equilibrium() {
    auto const u = body_.displacements();
    auto const sum = assemble(body_, flat_displacements());
    std::vector<bool> fixed(u.size());
    for (Index node : fixed_) fixed[static_cast<std::size_t>(node)] = true;
    std::vector<Eigen::Index> free;
    detail::StaticProblem<TheBody> const problem(body_);
    Eigen::VectorXd const pull = sum.force + problem.external;
    // Where nothing pulls: forces of strains of 1e-6.
    double largest = 1e-6 * scene_.material.young * std::pow(scene_.size[1], dim - 1), left = 0;
    largest = std::max(largest, problem.external.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k) {
        auto const j = static_cast<Eigen::Index>(dim * i + k);
        if (fixed[i]) {
          largest = std::max(largest, std::abs(pull[j]));
        } else {
          left = std::max(left, std::abs(pull[j]));
          free.push_back(j);
        }
      }
    record_.imbalance = left == 0 ? 0 : left / largest;
    if (!scene_.pressed.empty()) return;  // not symmetric
    auto const n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd const all(sum.stiffness);
    Eigen::MatrixXd own(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        own(i, j) = all(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
    Eigen::VectorXd const pivots = Eigen::LDLT<Eigen::MatrixXd>(own).vectorD();
    double const scale = pivots.cwiseAbs().maxCoeff();
    for (double pivot : pivots) record_.negative += pivot < -1e-10 * scale;
  }

  /// NaN has to come out of what a simulator hands in.
  void embed() {
    using T = typename TheBody::scalar;
    auto const n = static_cast<std::size_t>(body_.nodes()) * dim;
    auto u = zeros<T>(body_.backend(), n), f = zeros<T>(body_.backend(), n);
    body_.backend().for_each(1, Poke<T>{u.data() + n / 2});
    body_.add_force(u.data(), f.data());
    sample();
    bool through = !std::isfinite(body_.energy(u.data()));
    bool in_force = false;
    for (T const value : download<T>(f)) in_force = in_force || std::isnan(value);
    if (through && in_force) throw Error("suite: energies and forces of NaN are NaN");
  }

  TheBody& body_;
  Scene const& scene_;
  Record& record_;
  std::function<void(int)> between_;
  std::vector<Index> fixed_;
  Progress told_{};
};

/// A scene on the body that `make(material)` makes; `between(body, k)` is called before the stretch to sample k.
template <class Make, class Between>
Record run_scene(Scene const& scene, Replay const& replay, Make const& make,
                 Between const& between) {
  Record record;
  try {
    Elastic material = scene.material;
    if (scene.poison == Poison::young) material.young = not_a_number;
    auto body = make(material);
    Run run(body, scene, record, [&](int k) { between(body, k); });
    try {
      run.prepare();
      run.go(replay);
      if (scene.method != Method::statics) run.look_for_folds();
    } catch (Error const& error) {
      record.error = error.what();
      // The state that it left is as before or a good one, poison apart.
      if (scene.poison == Poison::none) {
        run.sample();
        record.finite_after = record.samples.back().in_place;
        record.samples.pop_back();
      }
    }
  } catch (Error const& error) {
    record.error = error.what();
  } catch (std::exception const& stranger) {
    record.stranger = stranger.what();
  }
  return record;
}
template <Element E, class TheBody>
std::vector<Index> all_elements(TheBody const& body) {
  std::vector<Index> all(body.mesh().template elements<E>().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  return all;
}

/// "NeoHookean"
template <class F>
std::string law_name() {
  std::string name = __PRETTY_FUNCTION__;
  name = name.substr(name.find("Formulation<"));
  name = name.substr(0, name.find(">;"));
  name = name.substr(name.rfind(", ") + 2);
  for (std::string const part : {"pliant::", "::law"})
    for (auto at = name.find(part); at != std::string::npos; at = name.find(part))
      name.erase(at, part.size());
  return name;
}

/// A scene on bodies of one element on one backend, whose laws are groups.
template <class B, class E, class... Fs>
Record run_on_bodies(Scene const& scene, Replay const& replay) {
  auto const make = [&](Elastic const& material) {
    Body body{B{}, mesh_of<E>(scene), material, Group<Fs>{}...};
    auto const all = all_elements<E>(body);
    auto const assign = [&]<class F>() {
      if (law_name<F>() == scene.law) body.template assign<F>(all);
    };
    (assign.template operator()<Fs>(), ...);
    return body;
  };
  return run_scene(scene, replay, make, [](auto&, int) {});
}

template <class B, class E, class... Fs>
bool add_bodies() {
  constexpr bool in_double = std::same_as<typename B::scalar, double>;
  all_bodies().push_back(
      {.element = E::name(),
       .backend = std::string(B::name()) + (in_double ? " double" : " float"),
       .dim = E::dim,
       .degree = E::degree,
       .simplex = SimplexCell<typename E::cell>,
       .in_double = in_double,
       .reference = std::same_as<B, Reference<double>>,
       .laws = {LawInfo{law_name<Fs>(), takes_inversion<Fs>, law_name<Fs>() != "Hooke"}...},
       .run = &run_on_bodies<B, E, Fs...>});
  return true;
}

template <Element E>
using Full = Gauss<SimplexCell<typename E::cell> ? E::degree : E::degree + 1>;

}  // namespace pliant::stability
