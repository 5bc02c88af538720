#pragma once

#include <atomic>
#include <vector>

#include <pliant/adaptation/rule.hpp>
#include <pliant/body/internal_variables.hpp>
#include <pliant/body/sleep.hpp>

// How far internal variables are from rest, in forces.
namespace pliant::detail {

/// Sets a flag, or another mark, that other threads may set at the same time.
PLIANT_HOST_DEVICE void set_flag(std::uint8_t& flag, std::uint8_t mark = 1) {
#if defined(__CUDA_ARCH__)
  flag = mark;
#else
  std::atomic_ref(flag).store(mark, std::memory_order_relaxed);
#endif
}
/// Reads one meanwhile.
PLIANT_HOST_DEVICE std::uint8_t flag_of(std::uint8_t& flag) {
#if defined(__CUDA_ARCH__)
  return flag;
#else
  return std::atomic_ref(flag).load(std::memory_order_relaxed);
#endif
}

/// A law whose points have relaxed: `internal` is (points), at the deformation at which they are asked.
template <class L, class Internal>
struct LawRelaxed {
  L const& law;
  Internal const& internal;
  PLIANT_HOST_DEVICE auto at_point(int q) const { return law.after(internal[q]); }
};

/// By how much the forces of an element will change when its points relax, |f_now − f_relaxed| in each direction, N.
template <class Laws>
struct RelaxationKernel {
  static constexpr bool reads_elements = true;
  Laws groups;

  template <int G, class Own, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, Own const& own, V const& rest,
                                     V const& u) const {
    using F = typename Laws::template formulation<G>;
    auto change = V::zero();
    if constexpr (internal_variables_of<F> > 0) {
      auto const& law = groups.template law<G>();
      using Internal = decltype(law.equilibrated(
          Tensor<std::remove_cvref_t<decltype(rest(0, 0))>, F::dim>::zero()));
      Internal internal[F::points];
      for_each_point<F>(
          rest, u, [&](int q, auto const& h) PLIANT_INLINE { internal[q] = law.equilibrated(h); });
      auto const now = force<F>(groups.template law<G>(own), rest, u);
      auto const relaxed = force<F>(
          LawRelaxed<std::remove_cvref_t<decltype(law)>, Internal[F::points]>{law, internal}, rest,
          u);
      for (int a = 0; a < F::nodes; ++a)
        for (int k = 0; k < F::dim; ++k) change(a, k) = abs(now(a, k) - relaxed(a, k));
    }
    return change;
  }
};

/// Marks the pieces of patches at nodes that elements around them would give a speed within a time by relaxing.
template <class T, int Dim>
struct MarkRelaxing {
  NodeField<T const, Dim> change;  // N
  T const* mass;
  T below, time;  // m/s, s
  Index const *first, *pieces;
  std::uint8_t* marked;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0))) return;  // masters of a slave tell
    auto const own = change.at(i);
    // NaN marks.
    if (square(time / m) * dot(own, own) <= below * below) return;
    for (Index k = first[i]; k < first[i + 1]; ++k) set_flag(marked[pieces[k]]);
  }
};

/// Which patches that are awake have points that relax by more than bodies at rest may be pulled at, 1 or 0.
template <class Parts>
std::vector<std::uint8_t> find_relaxing(Parts& parts, SleepRule const& rule) {
  using T = typename Parts::T;
  auto const& backend = parts.backend;
  auto const& rows = *parts.patch_nodes;
  auto changes = zeros<T>(backend, parts.layout.f.size());
  auto const change = node_field<Parts::dim>(changes);
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if constexpr (Table::Laws::internal_variable_count > 0)
      backend.template accumulate<Table::groups>(parts.awake_in(table),
                                                 RelaxationKernel<typename Table::Laws>{table.laws},
                                                 change, parts.rest(), std::as_const(parts).u());
  });
  parts.layout.interpolation.add_transpose(backend, change);
  auto marked = zeros<std::uint8_t>(backend, static_cast<std::size_t>(rows.pieces_count()));
  backend.for_each(parts.layout.rows,
                   MarkRelaxing<T, Parts::dim>{{changes.data()},
                                               parts.layout.mass.data(),
                                               static_cast<T>(rule.below),
                                               static_cast<T>(parts.state.integrator.step *
                                                              static_cast<double>(rule.for_steps)),
                                               rows.first.data(),
                                               rows.pieces.data(),
                                               marked.data()});
  return rows.marks_of_patches(backend, MarkOfPiece{marked.data()});
}

}  // namespace pliant::detail
