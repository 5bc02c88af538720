#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <pliant/law/elastic.hpp>

// What a case asks of a body, and what it is told, as plain data: the bodies, which take long to compile, are compiled
// apart from the cases.
namespace pliant::stability {

using Vec = std::array<double, 3>;  // z is zero in the plane

enum class Method { explicit_steps, local_steps, implicit_steps, backward_euler, statics };
inline constexpr std::array all_methods{Method::explicit_steps, Method::local_steps,
                                        Method::implicit_steps, Method::backward_euler,
                                        Method::statics};
inline char const* name_of(Method method) {
  constexpr std::array names{"CentralDifference", "LocalSteps", "implicit", "BackwardEuler",
                             "static"};
  return names[static_cast<std::size_t>(method)];
}

/// Where a case puts a number that is not one.
enum class Poison {
  none,
  rest_positions,
  displacements,
  velocities,
  one_load,
  loads,
  gravity,
  damping,
  pressure,
  motion,
  young,
  state_of_displacements,
  state_of_velocities,
  embedded_displacements
};

/// What a case changes before every sample.
enum class Toggle { none, law, quadrature, mesh, sleep, protective };
inline constexpr std::array all_toggles{Toggle::law, Toggle::quadrature, Toggle::mesh,
                                        Toggle::sleep};
inline char const* name_of(Toggle toggle) {
  constexpr std::array names{"none", "law", "quadrature", "mesh", "sleep", "protective"};
  return names[static_cast<std::size_t>(toggle)];
}

struct Scene {
  // The mesh: a rectangle or box of so many cells along each direction, whose nodes are then placed.
  Vec size{1, 1, 1};
  std::array<int, 3> cells{4, 4, 4};
  std::function<Vec(Vec const&)> place{};
  bool reversed = false;  // the order of each element's nodes
  Elastic material{2e6, 0.3, 1e3};
  std::string law{};

  std::vector<std::string> held{};  // boundaries
  std::string driven{};             // boundary
  std::function<Vec(Vec const& rest, double time)> motion{};
  Vec gravity{};
  double damping = 0;  // 1/s
  Vec load{};          // N, on the node nearest to load_at
  Vec load_at{};
  double pressure = 0;  // Pa
  std::string pressed{};
  std::function<Vec(Vec const&)> displacement{}, velocity{};

  Method method = Method::explicit_steps;
  double safety = 0.9;      // of steps that the integrator chooses
  double step = 0;          // s; 0: of its own
  double stable_steps = 0;  // instead: the step over the stable one
  double duration = 0;      // s
  int steps = 0;            // instead: so many
  int samples = 8;
  int load_steps = 1;
  Poison poison = Poison::none;
  Toggle toggle = Toggle::none;
};

/// A state on the way.
struct Sample {
  double time = 0;
  std::int64_t steps = 0;
  std::vector<Vec> u{};
  double strain = 0, kinetic = 0, potential = 0;  // J
  double work = 0;                                // J, booked by the body
  double error = 0;   // m: by how much displacements may be off, as the integrator tells
  bool lost = false;  // it tells that this is not known
  Vec momentum{}, spin{};
  double speed = 0;      // Σ m |v|, kg m/s
  double arm = 0;        // Σ m |x| |v|, kg m²/s
  bool in_place = true;  // displacements and velocities are finite
  bool finite = true;    // and energies
  double total() const { return strain + kinetic + potential; }
};

struct Record {
  std::vector<Sample> samples{};
  std::string error{};     // what Error said
  std::string stranger{};  // what any other exception said
  bool rolled_back = false;
  int retries = 0;
  bool finite_after = true;  // the state that an Error left
  double stable_step = 0;    // s, at the start
  double step = 0;           // s: the last one

  // Of statics.
  double imbalance =
      0;  // the largest force on a node that is free, over the largest reaction or load
  double least_J = std::numeric_limits<double>::infinity();
  int negative = 0;  // eigenvalues of the stiffness
};

/// Takes the times and steps of another record, with `times` as many steps between.
struct Replay {
  Record const* of = nullptr;
  int times = 4;
};

struct LawInfo {
  std::string name;
  bool takes_inversion, objective;
};

/// Bodies of one element on one backend, with all laws.
struct Bodies {
  std::string element, backend;
  int dim, degree;
  bool simplex, in_double, reference;
  std::vector<LawInfo> laws;
  Record (*run)(Scene const&, Replay const&);
};
/// All that are compiled into this program.
inline std::vector<Bodies>& all_bodies() {
  static std::vector<Bodies> list;
  return list;
}
/// Those that change on the way, or are of materials that differ between elements: see special.hpp.
inline std::vector<Bodies>& special_bodies() {
  static std::vector<Bodies> list;
  return list;
}

}  // namespace pliant::stability
