#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <pliant/backend/host_recording.hpp>
#include <pliant/solver/linear/linear_method.hpp>
#include <pliant/solver/linear/multigrid.hpp>

namespace pliant::detail {

/// By what the linear systems of one solve are preconditioned, and when that is made anew: where a system takes
/// half as many iterations again as the first one under it, for the same digits.
template <class Parts>
class Preconditioning {
  using Arrays = SolverArrays<typename Parts::backend_type>;
  using Matrix = ShiftedTangent<Parts>;

 public:
  explicit Preconditioning(Preconditioner wanted) : wanted_(wanted) {
    if (wanted != Preconditioner::automatic) now_ = wanted;
  }
  /// Nothing that was made before serves. A solve that begins so does not depend on those before it.
  void begin_anew() { made_ = false; }
  Preconditioner now() const { return now_; }
  bool is_nodal() const { return now_ == Preconditioner::nodal_blocks; }
  LinearReport const& report() const { return report_; }

  /// Before the iterations of a system.
  void begin(Parts const& parts, Arrays& arrays, Matrix const& a) {
    fresh_ = false;
    if (is_nodal())
      a.invert_blocks(parts, arrays.blocks.data(), {arrays.image.data()});
    else if (!made_)
      make(parts, arrays, a);
  }
  /// Whether `iterations` under nodal blocks, behind which the residual is a share of the first, foretell so many that
  /// multigrid costs less.
  bool should_turn_to_multigrid(Parts const& parts, int iterations, double share,
                                double tolerance) const {
    if (wanted_ != Preconditioner::automatic || !is_nodal() || iterations < look_behind ||
        Parts::dim * parts.layout.rows < fewest_unknowns)
      return false;
    double const rate = share < 1 ? std::log(share) / iterations : 0;
    return share > tolerance && std::log(tolerance / share) < worth * rate;
  }
  void turn_to_multigrid(Parts const& parts, Arrays& arrays, Matrix const& a) {
    // On GPUs linear elements between save less than making them takes on the host.
    now_ = on_host && is_quadratic(parts) && !lies_in_boxes(parts) ? Preconditioner::p_multigrid
                                                                   : Preconditioner::multigrid;
    make(parts, arrays, a);
  }
  /// Where rᵀ M r > 0 does not hold. False where there is nothing else.
  bool replace(Parts const& parts, Arrays& arrays, Matrix const& a) {
    if (is_nodal()) return false;
    if (!fresh_) {
      make(parts, arrays, a);
      return true;
    }
    ++report_.fallbacks;
    now_ = wanted_ = Preconditioner::nodal_blocks;
    begin(parts, arrays, a);
    return true;
  }
  /// A system that is solved by MINRES.
  void note_minres() { ++report_.minres; }
  /// Behind the iterations of a system, which left that share of the residual.
  void end(int iterations, double share) {
    report_.preconditioner = now_;
    report_.levels = is_nodal() ? 1 : levels_;
    report_.iterations += iterations;
    if (is_nodal()) return;
    double const digits = std::max(-std::log10(share), 1.0);
    if (fresh_) usual_ = iterations / digits;
    if (iterations > 1.5 * usual_ * digits + few) made_ = false;
  }
  /// What iterations call; null: nodal blocks.
  Multigrid<Parts> const* in(Arrays& arrays) const { return is_nodal() ? nullptr : &of(arrays); }

 private:
  static Multigrid<Parts>& of(Arrays& arrays) {
    return static_cast<Multigrid<Parts>&>(*arrays.preconditioner);
  }
  void make(Parts const& parts, Arrays& arrays, Matrix const& a) {
    if (now_ == Preconditioner::p_multigrid && !is_quadratic(parts))
      now_ = Preconditioner::multigrid;
    parts.backend.synchronize();
    auto const start = std::chrono::steady_clock::now();
    if (!arrays.preconditioner || of(arrays).kind() != now_) {
      arrays.recorded.reset();
      arrays.preconditioner.reset();
      arrays.preconditioner = std::make_unique<Multigrid<Parts>>(parts, now_);
    }
    of(arrays).prepare(parts, arrays, a);
    parts.backend.synchronize();
    report_.setup +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    levels_ = of(arrays).levels();
    ++report_.hierarchies;
    made_ = fresh_ = true;
  }

  static constexpr bool on_host =
      std::same_as<typename Parts::backend_type::Recording, HostRecording>;
  // Making multigrid costs about as much as 60 iterations under nodal blocks, each of its iterations 6.
  static constexpr int look_behind = 16, worth = 100, few = 4;
  static constexpr Index fewest_unknowns = on_host ? 3000 : 300000;
  Preconditioner wanted_, now_ = Preconditioner::nodal_blocks;
  bool made_ = false, fresh_ = false;  // at all, and from this system's matrix
  double usual_ = 0;  // iterations by which a fresh one made a residual ten times smaller
  int levels_ = 1;
  LinearReport report_{};
};

}  // namespace pliant::detail
