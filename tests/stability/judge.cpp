#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "stability/cases.hpp"

namespace pliant::stability {
namespace {

double length(Vec const& v) { return std::hypot(v[0], v[1], v[2]); }

double norm_of(Sample const& s, Sample const* less = nullptr) {
  double sum = 0;
  // Nodes of a refined mesh that are not in the other are left out.
  std::size_t const count = less ? std::min(s.u.size(), less->u.size()) : s.u.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      double const x = s.u[i][k] - (less ? less->u[i][k] : 0);
      sum += x * x;
    }
  return std::sqrt(sum);
}

/// How far two records are apart, over the largest displacement from the start.
double apart(Record const& a, Record const& b) {
  double difference = 0, scale = 0;
  for (std::size_t k = 0; k < a.samples.size() && k < b.samples.size(); ++k) {
    difference = std::max(difference, norm_of(a.samples[k], &b.samples[k]));
    scale = std::max(scale, norm_of(b.samples[k], &b.samples[0]));
  }
  return difference == 0 ? 0 : difference / scale;
}

/// The largest part of a displacement, m, or of what it has over another.
double largest_of(Sample const& s, Sample const* less = nullptr) {
  double most = 0;
  std::size_t const count = less ? std::min(s.u.size(), less->u.size()) : s.u.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, std::abs(s.u[i][k] - (less ? less->u[i][k] : 0)));
  return most;
}
/// Whether the integrator has told, at every sample, of an error at least as large as how far displacements are off, or
/// that it does not know any more.
bool is_told(Record const& record, Record const& reference) {
  for (std::size_t k = 0; k < record.samples.size() && k < reference.samples.size(); ++k)
    if (auto const& own = record.samples[k];
        !own.lost && !(largest_of(own, &reference.samples[k]) <= own.error))
      return false;
  return true;
}

/// The energy's largest and last excess over the start, less what is booked, over the largest strain and kinetic energy.
struct Drift {
  double either = 0, up = 0;
};
Drift drift_of(Record const& record) {
  Drift drift;
  double scale = 0;
  auto const& first = record.samples.front();
  for (auto const& s : record.samples) {
    scale = std::max(scale, s.strain + s.kinetic);
    double const excess = (s.total() - s.work) - (first.total() - first.work);
    drift.either = std::max(drift.either, std::abs(excess));
    drift.up = std::max(drift.up, excess);
  }
  if (scale > 0) drift = {drift.either / scale, drift.up / scale};
  return drift;
}

struct Change {
  double momentum = 0, spin = 0;
};
Change change_of(Record const& record) {
  Change change;
  double speed = 0, arm = 0;
  auto const& first = record.samples.front();
  for (auto const& s : record.samples) {
    Vec p, l;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = s.momentum[k] - first.momentum[k];
      l[k] = s.spin[k] - first.spin[k];
    }
    change = {std::max(change.momentum, length(p)), std::max(change.spin, length(l))};
    speed = std::max(speed, s.speed);
    arm = std::max(arm, s.arm);
  }
  return {speed > 0 ? change.momentum / speed : 0, arm > 0 ? change.spin / arm : 0};
}

/// Whether a user can read what went wrong.
bool is_sentence(std::string const& text) {
  std::istringstream words(text);
  std::string word;
  int count = 0;
  while (words >> word) ++count;
  return count >= 5;
}

/// Collects what was measured, and what of it is beyond its bound.
class Findings {
 public:
  bool within(char const* name, double value, double bound) {
    bool const good = value <= bound;
    char text[120];
    std::snprintf(text, sizeof text, "%s%s=%.2g/%.2g", figures_.empty() ? "" : " ", name, value,
                  bound);
    figures_ += text;
    if (!good) missed_ += (missed_.empty() ? "" : ", ") + std::string(name);
    return good;
  }
  /// Tells what is not judged.
  void note(char const* name, double value) {
    char text[80];
    std::snprintf(text, sizeof text, "%s%s=%.2g", figures_.empty() ? "" : " ", name, value);
    figures_ += text;
  }
  void miss(std::string const& what) { missed_ += (missed_.empty() ? "" : ", ") + what; }
  std::string const& figures() const { return figures_; }
  std::string const& missed() const { return missed_; }

 private:
  std::string figures_, missed_;
};

}  // namespace

Verdict judge(Case const& one) {
  auto const& demands = one.demands;
  Record const record = one.bodies->run(one.scene, {});
  if (!record.stranger.empty())
    return {Outcome::crashes, "", "an exception that is no Error: " + record.stranger};
  if (!record.error.empty()) {
    if (!is_sentence(record.error))
      return {Outcome::wrong, "", "no clear sentence: " + record.error};
    if (!record.finite_after)
      return {Outcome::wrong, "", "the body that is left is not finite: " + record.error};
    return {Outcome::reports, "", record.error};
  }
  Findings found;
  if (demands.must_report) found.miss("no report");
  bool finite = true;
  for (auto const& s : record.samples) finite = finite && s.finite;
  if (!finite) found.miss("not finite");

  bool told = false;  // all that is missed, as an error
  auto const compare = [&](Findings& f) {
    Record const reference = one.reference->run(one.scene, {.of = &record});
    if (!reference.error.empty() || !reference.stranger.empty())
      return "the reference ends with: " + reference.error + reference.stranger;
    told = !f.within("apart", apart(record, reference), 0.01) && is_told(record, reference);
    return std::string();
  };
  if (finite) {
    bool const in_double = one.bodies->in_double;
    auto const drift = drift_of(record);
    auto const kept = [&](Findings& f) {
      return (demands.or_drift >= 0 && f.within("drift", drift.either, demands.or_drift)) ||
             (demands.or_growth >= 0 && f.within("growth", drift.up, demands.or_growth));
    };
    if (demands.close) {
      Findings tried = found;
      auto const text = compare(tried);
      if (!text.empty()) tried.miss(text);
      if (Findings instead = found; tried.missed() == found.missed() || !kept(instead))
        found = tried;
      else
        found = instead;
    }
    if (demands.drift >= 0) found.within("drift", drift.either, demands.drift);
    if (demands.growth >= 0) found.within("growth", drift.up, demands.growth);
    auto const change = change_of(record);
    double const rounding =
        (in_double ? 1e-13 : 1e-5) *
        std::max<double>(1, std::sqrt(static_cast<double>(record.samples.back().steps)));
    if (demands.momentum) found.within("momentum", change.momentum, rounding);
    if (demands.spin) found.within("spin", change.spin, rounding);
    auto const &first = record.samples.front(), &last = record.samples.back();
    if (demands.calm)
      found.within("kinetic",
                   last.kinetic / std::max({first.strain + first.kinetic, last.strain, 1e-300}),
                   1e-3);
    if (demands.returns)
      told = !found.within("left", norm_of(last) / norm_of(first), 1e-3) &&
             (last.lost || largest_of(last) <= last.error);
    if (demands.unfolded)
      found.within("-det F", -record.least_J, 0);
    else if (!(record.least_J > 0))
      found.note("det F", record.least_J);
    if (demands.still)
      found.within("kinetic", last.kinetic / one.scene.material.young, in_double ? 1e-26 : 1e-10);
    if (demands.rest) {
      // Close to the reference, or an equilibrium by other means than the solver's.
      Findings balanced = found, near = found;
      balanced.within("imbalance", record.imbalance, in_double ? 1e-8 : 1e-4);
      balanced.within("negative", record.negative, 0);
      if (balanced.missed() == found.missed()) {
        found = balanced;
      } else {
        auto const text = compare(near);
        if (text.empty() && near.missed() == found.missed()) {
          found = near;
        } else {
          compare(balanced);
          found = balanced;
          if (!text.empty()) found.miss(text);
        }
      }
      if (!(record.least_J > 0) && one.scene.law != "Hooke") found.miss("folded");
    }
  }
  Verdict verdict{Outcome::works, found.figures(), ""};
  if (!found.missed().empty()) {
    verdict.text = found.missed();
    verdict.outcome =
        finite && (record.rolled_back || record.retries > 0) ? Outcome::reports : Outcome::wrong;
    if (verdict.outcome == Outcome::reports) verdict.text = "rolled back; " + verdict.text;
    if (told && (verdict.text == "apart" || verdict.text == "left")) {
      auto const& last = record.samples.back();
      char error[80];
      std::snprintf(
          error, sizeof error,
          last.lost ? "tells that errors of %.2g m are too large; " : "tells an error of %.2g m; ",
          last.error);
      verdict = {Outcome::reports, verdict.figures, error + verdict.text};
    }
  }
  return verdict;
}

}  // namespace pliant::stability
