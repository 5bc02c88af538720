#pragma once

#include "stability/scene.hpp"

// The cases of the suite, and when one of them works.
namespace pliant::stability {

/// What has to hold for a case to work; of bounds that are negative nothing is asked. Finite values always are.
struct Demands {
  bool close = false;     // within 1% of Reference in double at a quarter of the step, or else
  double or_drift = -1;   // as drift below, or
  double or_growth = -1;  // as growth
  double drift = -1;   // of the energy less booked work, over the largest strain and kinetic energy
  double growth = -1;  // the same, upwards alone
  bool momentum = false;  // linear, kept to rounding
  bool spin = false;      // angular, kept to rounding
  bool calm =
      false;  // in the end 1e-3 of the energy at the start, or of the strain energy, is kinetic, at the most
  bool returns = false;      // displacements shrink to 1e-3 of those at the start
  bool still = false;        // nothing moves but by rounding
  bool rest = false;         // statics: close, or an equilibrium that is unfolded and stable
  bool unfolded = false;     // det F is positive in the end
  bool must_report = false;  // nothing but a report is honest
};

struct Case {
  std::string scene_name, variant;
  Scene scene;
  Demands demands;
  Bodies const* bodies;
  Bodies const* reference;  // of the same element
  int quick = 0;            // 1: in the quick form

  /// How many times as long as others it may take: a run of 1e6 steps is slow, it does not hang.
  int patience() const { return scene.steps > 100000 ? 10 : 1; }
  /// scene|variant|element|law|integrator|backend
  std::string key() const {
    return scene_name + "|" + variant + "|" + bodies->element + "|" + scene.law + "|" +
           name_of(scene.method) + "|" + bodies->backend;
  }
};

/// All cases for the bodies that are compiled in; in the quick form few.
std::vector<Case> all_cases(bool quick);

enum class Outcome { works, reports, wrong, hangs, crashes };
inline char const* name_of(Outcome outcome) {
  constexpr std::array names{"works", "reports", "SILENTLY WRONG", "HANGS", "CRASHES"};
  return names[static_cast<std::size_t>(outcome)];
}

struct Verdict {
  Outcome outcome = Outcome::works;
  std::string figures{};  // what was measured, "name=value/bound ..."
  std::string text{};     // what Error said, or what is wrong
};

Verdict judge(Case const& one);

}  // namespace pliant::stability
