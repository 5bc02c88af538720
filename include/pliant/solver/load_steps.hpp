#pragma once

#include <cstdint>
#include <string>

#include <pliant/error.hpp>
#include <pliant/solver/newton_options.hpp>

namespace pliant::detail {

/// A stretch of the way along which loads and motions grow: shares of what they come to.
struct LoadStep {
  double from = 0, to = 1;

  std::string name() const { return message({"between ", from, " and ", to, " of the loads"}); }
};

/// Thrown where a load step does not succeed but a shorter one may.
struct LoadStepFailed : Error {
  using Error::Error;
};

inline void refuse_folds(NewtonOptions const& options, LeastJacobian const& folded) {
  if (!options.accept_folded && !(folded.value > 0))
    throw LoadStepFailed(
        "solve_static: the answer is folded: det F comes to ", folded.value, " in ", folded.element,
        " element ", folded.number,
        ", perhaps between the points of its quadrature; take more points, a finer mesh "
        "there or more load_steps, or accept it by accept_folded");
}

inline std::string folded_start() {
  return "solve_static: energy or forces are not finite where load steps start: an element is "
         "folded there; start from "
         "displacements without folds";
}
inline std::string no_convergence(LoadStep const& step, int iterations, double residual) {
  return message({"solve_static: no convergence ", step.name(), " after ", iterations,
                  " iterations, residual ", residual,
                  " N; use more load_steps or load_halvings, or a law that does not soften"});
}

/// Goes from nothing to all of the loads in the steps that the options ask for. A step that throws LoadStepFailed is
/// halved, so often as they allow, and after two that succeeded steps grow again. `take` a step; go_back() to the end of
/// the last that succeeded. Returns how many did.
template <class Take, class GoBack>
int follow_loads(NewtonOptions const& options, Take const& take, GoBack const& go_back) {
  std::int64_t const longest = std::int64_t{1} << options.load_halvings;
  std::int64_t const all = options.load_steps * longest;
  auto const share = [all](std::int64_t steps) {
    return static_cast<double>(steps) / static_cast<double>(all);
  };
  std::int64_t done = 0, length = longest;
  int taken = 0, in_a_row = 0;
  while (done < all) {
    std::int64_t const end = done + length < all ? done + length : all;
    try {
      take(LoadStep{share(done), share(end)});
    } catch (LoadStepFailed const&) {
      if (length == 1) throw;
      go_back();
      length /= 2;
      in_a_row = 0;
      continue;
    }
    done = end;
    ++taken;
    if (++in_a_row < 2 || length == longest) continue;
    length *= 2;
    in_a_row = 0;
  }
  return taken;
}

}  // namespace pliant::detail
