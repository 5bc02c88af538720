#pragma once

#include <memory>
#include <optional>
#include <sstream>

#include <pliant/body/compare.hpp>
#include <pliant/solver/local_steps.hpp>

#include "support/backends.hpp"
#include "support/fields.hpp"
#include "support/meshes.hpp"

namespace pliant::storm {

struct Options {
  std::int64_t steps = 2000;
  unsigned seed = 1;
  int cells = 0;        // along the edges of meshes; 0: few
  bool ledger = false;  // leave out what the ledger does not know, and check that it closes
};

/// What a storm found wrong.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Report {
  std::int64_t steps = 0, restarts = 0, retries = 0, refused = 0, epochs = 0, driven = 0,
               pressed = 0, slept = 0;   // slept: epochs in which patches did
  std::int64_t local = 0;                // steps that were macro steps of LocalSteps
  std::int64_t largest_mesh = 0;         // nodes
  double switched = 0;                   // elements that changed their group
  std::map<std::string, double> missed;  // by the ledger, of each kind of event, over the same
  double worst_ledger_error = 0;         // over the largest energy
};

/// Lets patches of a body sleep that move less than a storm's bodies do most of the time.
template <class TheBody>
void let_rest(TheBody& body) {
  if constexpr (!TheBody::has_internal_variables) {
    static Adaptation rest = Adaptation{sleep({.below = 0.01, .for_steps = 4})}.every(2);
    rest(body);
  }
}

/// Random events on two bodies: one runs on, the other is again and again made anew from what the first
/// one saved. Both must be the same to the bit whenever they are compared.
template <class Scene>
class Storm {
  using TheBody = typename Scene::body_type;
  static constexpr int dim = TheBody::dim;
  static constexpr std::size_t size = dim;

 public:
  Storm(Scene scene, Options options)
      : scene_(std::move(scene)), options_(options), random_(options.seed) {}

  Report run() {
    while (report_.steps < options_.steps) {
      begin_epoch();
      auto const end = report_.steps + 300 + static_cast<std::int64_t>(random_.below(900));
      auto next_restart = report_.steps;
      while (report_.steps < end && report_.steps < options_.steps) {
        round();
        if (report_.steps < next_restart) continue;
        compare();
        restart();
        next_restart = report_.steps + 20 + static_cast<std::int64_t>(random_.below(100));
      }
      compare();
      report_.switched += switches();
      report_.slept += slept_;
    }
    return report_;
  }
  /// What has happened so far.
  Report const& report() const { return report_; }
  /// Where in the storm it is.
  std::string where() const {
    return "seed " + std::to_string(options_.seed) + ", epoch " + std::to_string(report_.epochs) +
           ", step " + std::to_string(report_.steps) + ", last event: " + event_;
  }

 private:
  void begin_epoch() {
    ++report_.epochs;
    event_ = "begin";
    rests_ = random_.below(3) == 0;
    local_ = !options_.ledger && random_.below(3) == 0;
    slept_ = false;
    motions_.clear();
    kept_.reset();
    missed_ = largest_energy_ = 0;
    missed_by_.clear();
    one_.reset();
    other_.reset();
    one_.emplace(scene_.body());
    if (random_.below(3) > 0) one_->clamp(one_->mesh().boundary("left"));
    one_->set_gravity(point(0.02));
    if (!options_.ledger) one_->set_damping(0.5);
    one_->set_velocities(
        random_.template field<dim>(static_cast<std::size_t>(one_->nodes()), 0.01));
    restart();
  }

  /// Makes the other body anew, from what the one saves.
  void restart() {
    bind(*one_);
    other_.reset();
    other_.emplace(scene_.body());
    give_motions(*other_);
    std::istringstream stream(saved(*one_));
    other_->load(stream);
    bind(*other_);
    ++report_.restarts;
  }
  /// The integrator that a body is loaded with is the one that advanced it.
  void bind(TheBody& body) { advance(body, 0); }
  void advance(TheBody& body, int steps) {
    if (local_)
      local_steps_(body, steps);
    else
      step_(body, steps);
  }
  void give_motions(TheBody& body) {
    for (auto const& [name, motion] : motions_)
      body.release(body.drive(std::vector<Index>{0}, motion, {.name = name}));
  }

  static std::string saved(TheBody const& body) {
    std::ostringstream stream;
    body.save(stream);
    return stream.str();
  }
  static void load(TheBody& body, std::string const& bytes) {
    std::istringstream stream(bytes);
    body.load(stream);
  }

  void compare() {
    auto const different = first_difference(one_->state(), other_->state());
    if (!different.empty()) throw Failure("the restored body differs in its " + different);
    if (saved(*one_) != saved(*other_)) throw Failure("the restored body saves other bytes");
    // By bits: too large a step leads where energies are no numbers.
    auto const same = [&](char const* what, auto const& read) {
      std::string bytes[2];
      detail::ByteWriter(bytes[0]).put(read(*one_));
      detail::ByteWriter(bytes[1]).put(read(*other_));
      if (bytes[0] != bytes[1]) throw Failure(std::string("the restored body reads other ") + what);
    };
    same("displacements", [](auto& body) { return body.displacements(); });
    same("velocities", [](auto& body) { return body.velocities(); });
    same("strain energy", [](auto& body) { return strain_energy(body); });
  }

  /// Does the same to both bodies; an Error must be the same, and leave them the same.
  template <class Act>
  bool both(Act const& act) {
    std::string error[2];
    TheBody* const bodies[2] = {&*one_, &*other_};
    for (int k = 0; k < 2; ++k) try {
        act(*bodies[k]);
      } catch (Error const& e) {
        error[k] = e.what();
      }
    if (error[0] != error[1])
      throw Failure("one body says \"" + error[0] + "\", the other \"" + error[1] + "\"");
    if (error[0].empty()) return true;
    ++report_.refused;
    last_error_ = error[0];
    compare();
    return false;
  }

  void round() {
    auto const node = static_cast<Index>(random_.below(static_cast<std::size_t>(one_->nodes())));
    auto const steps = 1 + static_cast<int>(random_.below(6));
    for (int k = 0; k < 3; ++k) {
      auto const force = point(0.002);
      event_ = "load";
      booked([&] { both([&](auto& body) { body.set_load(node, force); }); });
      auto const before = one_->steps();
      event_ = "steps";
      bool went = true;
      booked([&] { went = both([&](auto& body) { advance(body, steps); }); });
      if (!went) throw Failure("an ordinary step fails: " + last_error_);
      auto const taken = std::max<std::int64_t>(one_->steps() - before, 1);
      report_.steps += taken;
      if (local_) report_.local += taken;
      event_ = "sleep";
      if (rests_) booked([&] { both([&](auto& body) { let_rest(body); }); });
      event_ = "switching";
      booked([&] { both([&](auto& body) { scene_.switch_groups(body); }); });
      event_ = "refining";
      booked([&] { both([&](auto& body) { scene_.make_finer(body); }); });
    }
    slept_ = slept_ || one_->parts().awake;
    report_.largest_mesh = std::max(report_.largest_mesh, std::int64_t{one_->nodes()});
    if (!std::isfinite(test::largest(one_->displacements()))) throw Failure("not finite");
    auto const what = random_.below(15);
    if (what == 11) {  // not for the ledger: the energy is another one
      happen(what);
      missed_ = missed_of_kept_;
    } else {
      booked([&] { happen(what); });
    }
  }

  void happen(std::size_t what) {
    switch (what) {
      case 0: {
        event_ = "gravity";
        auto const g = point(0.03);
        both([&](auto& body) { body.set_gravity(g); });
        break;
      }
      case 1:
        event_ = "hold";
        if (one_->state().prescribed->conditions.size() < 3) hold();
        break;
      case 2:
        event_ = "drive";
        if (!options_.ledger && one_->state().prescribed->conditions.size() < 3) drive();
        break;
      case 3:
        event_ = "press";
        if (!options_.ledger) press();
        break;
      case 4:
      case 5:
        event_ = "release";
        release();
        break;
      case 6: {
        event_ = "refine";
        unsigned const seed = static_cast<unsigned>(random_.below(1u << 30));
        both([&](auto& body) { scene_.refine(body, seed); });
        break;
      }
      case 7: {
        event_ = "assign";
        unsigned const seed = static_cast<unsigned>(random_.below(1u << 30));
        both([&](auto& body) { scene_.assign(body, seed); });
        break;
      }
      case 8:
        event_ = "too large a step";
        step_too_far();
        break;
      case 9:  // reading changes nothing, in one of the two
        event_ = "read";
        (void)total_energy(*one_);
        (void)one_->forces();
        both([&](auto& body) { advance(body, 1); });  // after which velocities lag behind in both
        break;
      case 10:  // nor does what was just saved
        event_ = "load again";
        load(*one_, saved(*one_));
        bind(*one_);
        break;
      case 11:
        event_ = "go back";
        if (kept_ && random_.below(2) == 0) {
          both([&](auto& body) {
            load(body, *kept_);
            bind(body);
          });
          kept_.reset();
        } else {
          kept_ = saved(*one_);
          missed_of_kept_ = missed_;
        }
        break;
      case 12: {
        event_ = "velocities";
        auto const v = random_.template field<dim>(static_cast<std::size_t>(one_->nodes()), 0.01);
        both([&](auto& body) { body.set_velocities(v); });
        break;
      }
      case 13:
        event_ = "the other integrator";
        if (options_.ledger) break;
        local_ = !local_;
        both([&](auto& body) { bind(body); });
        break;
      default: {
        event_ = "damping";
        if (options_.ledger) break;
        double const damping = 0.3 + 0.2 * random_();
        both([&](auto& body) { body.set_damping(damping); });
      }
    }
  }

  std::string side() {
    static constexpr char const* names[] = {"left", "right", "bottom", "top"};
    return names[random_.below(4)];
  }
  DirectionMask directions() {
    return static_cast<DirectionMask>(1 + random_.below(all_directions<dim>));
  }
  Point<dim> point(double length) { return random_.template field<dim>(1, length)[0]; }

  void hold() {
    auto const facets = one_->mesh().boundary(side());
    auto const which = directions();
    both([&](auto& body) { body.hold(facets, which); });
  }
  /// From where its nodes are, to and fro.
  void drive() {
    auto const nodes = nodes_of(one_->mesh().boundary(side()));
    auto const u = one_->displacements();
    auto begin = std::make_shared<std::map<Point<dim>, Point<dim>>>();
    for (Index node : nodes)
      begin->emplace(one_->mesh().nodes[static_cast<std::size_t>(node)],
                     u[static_cast<std::size_t>(node)]);
    auto const reach = point(0.01);
    double const start = one_->time();
    Motion<dim> const motion = [begin, reach, start](Point<dim> const& place, double time) {
      auto const found = begin->find(place);
      auto to = found == begin->end() ? Point<dim>{} : found->second;
      for (std::size_t k = 0; k < size; ++k) to[k] += reach[k] * (1 - std::cos(time - start));
      return to;
    };
    std::string const name = "motion " + std::to_string(++report_.driven);
    auto const which = directions();
    if (both([&](auto& body) { body.drive(nodes, motion, {.directions = which, .name = name}); }))
      motions_.emplace(name, motion);
  }
  void press() {
    auto const facets = one_->mesh().boundary(side());
    double const pressure = 0.01 * random_();
    if (both([&](auto& body) { body.press(facets, pressure); })) ++report_.pressed;
  }
  void release() {
    auto const& prescribed = *one_->state().prescribed;
    std::vector<Handle> handles;
    for (auto const& c : prescribed.conditions) handles.push_back(c.handle);
    for (auto const& p : prescribed.pressures) handles.push_back(p.handle);
    if (handles.empty()) return;
    auto const handle = handles[random_.below(handles.size())];
    both([&](auto& body) { body.release(handle); });
  }
  /// A stretch with a step that does not hold is rolled back, or given up; both bodies go the same way.
  void step_too_far() {
    auto const before = saved(*one_);
    double const factor = 2.5 + random_();
    CentralDifference large{
        {.step = factor * stable_step(*one_), .check_interval = 24, .watch_interval = 7}};
    (void)stable_step(*other_);
    both([&](auto& body) { large(body, 60); });
    report_.retries += large.retries();
    compare();
    both([&](auto& body) {
      load(body, before);
      bind(body);
    });
  }

  /// The energy that time integration keeps, J: with leapfrog's kinetic energy, less what is booked.
  double kept_energy() {
    auto& parts = one_->parts();
    double const step = parts.state.integrator.step;
    return total_energy_of(parts) - step * step * acceleration_term(parts) - booked_energy(parts);
  }
  /// Does something of which the ledger is to know, and notes what it misses.
  template <class Act>
  void booked(Act const& act) {
    if (!options_.ledger) return act();
    (void)other_->velocities();  // the ledger reads those of the one
    auto const& own = one_->state().integrator;
    double const begin = own.first_energy, before = kept_energy();
    act();
    (void)other_->velocities();
    double const after = kept_energy();
    // Another step is another leapfrog: the integrator shifts the energy that it compares with.
    double const shift = event_ == "steps" ? own.first_energy - begin : 0;
    largest_energy_ = std::max({largest_energy_, std::abs(total_energy(*one_)),
                                strain_energy(*one_) + kinetic_energy(*one_)});
    if (std::isfinite(shift)) missed_ += after - before - shift;
    if (std::isfinite(shift)) missed_by_[event_] += std::abs(after - before - shift);
    double const error = std::abs(missed_) / largest_energy_;
    report_.worst_ledger_error = std::max(report_.worst_ledger_error, error);
    for (auto& [event, sum] : missed_by_)
      report_.missed[event] = std::max(report_.missed[event], sum / largest_energy_);
  }
  double switches() {
    double sum = 0;
    for (auto const& entry : ledger(*one_))
      if (entry.action.find(" group ") != std::string::npos) sum += entry.elements;
    return sum;
  }

  Scene scene_;
  Options options_;
  test::Random random_;
  Report report_;
  std::optional<TheBody> one_, other_;
  CentralDifference step_{{.safety = 0.3,
                           .check_interval = 32,
                           .refresh_interval = 100,
                           .energy_growth = options_.ledger ? 0.1 : 0.9}};
  LocalSteps local_steps_{{.safety = 0.3, .check_interval = 32, .refresh_interval = 100}};
  bool local_ = false;  // which of the two steps
  std::map<std::string, Motion<dim>> motions_;
  std::optional<std::string> kept_;
  bool rests_ = false, slept_ = false;  // in this epoch: whether patches may sleep, and did
  std::string event_, last_error_;
  // J: missed by the ledger in this epoch; of each event, without sign; the largest energy so far
  double missed_ = 0, missed_of_kept_ = 0;
  std::map<std::string, double> missed_by_;
  double largest_energy_ = 0;
};

}  // namespace pliant::storm
