#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include <pliant/backend/value_at.hpp>
#include <pliant/body/velocities.hpp>
#include <pliant/formulation/one_gradient.hpp>
#include <pliant/math/eigenvalue_bounds.hpp>

namespace pliant {

namespace detail {

/// Writes a bound of the largest eigenvalue of M_e⁻¹ K_e, 1/s², for each element.
template <class T, class Laws>
struct ElementSpectra {
  static constexpr int counters = 0;
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  T density;
  T* bound;  // (elements)

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    using F = typename Laws::template formulation<G>;
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          using E = typename F::element;
          using S = std::remove_cvref_t<decltype(rest(0, 0))>;
          auto const volumes = nodal_volumes<E>(rest);
          Vector<S, E::nodes> scale;
          for (int a = 0; a < E::nodes; ++a) scale[a] = S(1) / sqrt(density * volumes[a]);
          Vector<S, 1> result;
          result[0] = bound_of_scaled<F>(law, rest, u, scale);
          return result;
        },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    bound[e] = value[0];
  }

 private:
  /// Of D K D, where D is diagonal and has `scale` for the directions of a node.
  template <class F, class Law, class S, class Values>
  PLIANT_HOST_DEVICE static S bound_of_scaled(Law const& law, Values const& rest, Values const& u,
                                              Vector<S, F::nodes> const& scale) {
    constexpr int dim = F::dim, size = F::nodes * dim;
    if constexpr (has_one_gradient<F>) {  // and all nodes the same mass
      return bound_by_powers(one_gradient<F>(law, rest, u).of_gradients(square(scale[0])));
    } else if constexpr (has_large_stiffness<F>) {
      return bound_by_products<S, size>([&](Vector<S, size> const& x) PLIANT_INLINE {
        Values du;
        for (int i = 0; i < size; ++i) du(i / dim, i % dim) = scale[i / dim] * x[i];
        auto const df = tangent_product<F>(law, rest, u, du);
        Vector<S, size> product;
        for (int i = 0; i < size; ++i) product[i] = -scale[i / dim] * df(i / dim, i % dim);
        return product;
      });
    } else {
      auto k = stiffness<F>(law, rest, u);
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) k(i, j) = k(i, j) * scale[i / dim] * scale[j / dim];
      return bound_by_powers(k);
    }
  }
};

/// The largest row sum over mass of a free direction.
template <class T, int Dim>
struct RowOverMass {
  NodeField<T const, Dim> rows;
  T const* mass;
  DirectionMask const* held;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    double largest = 0;
    if (mass[i] > T(0))
      for (int k = 0; k < Dim; ++k)
        if (!(held[i] >> k & 1))
          largest = max(largest, infinite_if_not_finite(static_cast<double>(rows(i, k)) /
                                                        static_cast<double>(mass[i])));
    return largest;
  }
};

/// Which elements a bound is asked of.
enum class Among { all, awake };

/// Which bounds are asked for: both, or that of rows alone, which takes less time.
enum class Bounds { both, of_rows };

/// Two upper bounds of ω², 1/s²; infinite where one is not asked for.
template <class Parts>
FrequencyBounds frequency_bounds(Parts& parts, Among among, Bounds wanted = Bounds::both) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& backend = parts.backend;
  auto const at = std::as_const(parts).here();
  double const magnitude = parts.layout.interpolation.magnitude();
  if (parts.row_sums.size() != parts.layout.f.size())
    parts.row_sums = zeros<T>(backend, parts.layout.f.size());
  NodeField<T, dim> const rows{parts.row_sums.data()};
  clear_rows(parts, rows);
  auto const largest_row = [&] {
    return backend.maximum(parts.layout.rows,
                           detail::RowOverMass<T, dim>{
                               {parts.row_sums.data()},
                               parts.layout.mass.data(),
                               among == Among::awake ? parts.still() : parts.layout.held.data()});
  };
  // Terms beside the elements have no mass of their own: only their rows bound them.
  double by_terms = 0;
  for_each_added_term(parts, [&](auto const& term) { term.add_row_sums(backend, at, rows); });
  if (!parts.pressures.empty() || !parts.terms.empty()) {
    parts.layout.interpolation.hand_on_magnitudes(backend, rows);
    by_terms = magnitude * largest_row();
  }
  (among == Among::awake ? parts.awake_elements() : parts.elements())
      .add_row_sums(backend, at, rows);
  double by_elements = wanted == Bounds::both ? 0 : std::numeric_limits<double>::infinity();
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0 || wanted == Bounds::of_rows) return;
    using Laws = typename Table::Laws;
    if (table.scratch.size() == 0)
      table.scratch = zeros<T>(backend, static_cast<std::size_t>(table.count()));
    bool const awake = among == Among::awake && parts.awake;
    auto const& const_table = std::as_const(table);
    auto const elements = awake ? parts.awake_in(const_table) : active(const_table.elements);
    backend.template visit<Table::groups>(
        elements,
        detail::ElementSpectra<T, Laws>{table.laws, static_cast<T>(parts.material.density),
                                        table.scratch.data()},
        parts.no_counters, at.rest, at.u);
    by_elements = std::max(
        by_elements, detail::largest_of(backend, elements, std::as_const(table.scratch).data()));
  });
  parts.layout.interpolation.hand_on_magnitudes(backend, rows);
  return {magnitude * magnitude * by_elements + by_terms, magnitude * largest_row()};
}

/// The better one, 1/s². Throws Error when there is none.
template <class Parts>
double squared_frequency(Parts const& parts, FrequencyBounds const& bounds) {
  double const eigenvalue = std::min(bounds.elements, bounds.rows);
  if (!std::isfinite(eigenvalue) || !(eigenvalue > 0))
    throw Error("stable_step: the stiffness of the body is ",
                eigenvalue > 0 ? "not finite" : "zero", " at time ", parts.state.time,
                " s; an element has collapsed, or every node is held");
  return eigenvalue;
}
template <class Parts>
double squared_frequency_bound(Parts& parts) {
  return squared_frequency(parts, frequency_bounds(parts, Among::all));
}

}  // namespace detail

/// A time step, s, below which central differences are certain to be stable for the body frozen in
/// its present state: 2/ω with ω² bounded in two ways, of which the better is taken. Either by the
/// largest element eigenvalue of M_e⁻¹ K_e (Irons and Treharne 1971), or by unassembled Gershgorin
/// discs, max_i Σ_e Σ_j |K_e,ij| / m_i, rows of slaves added to their masters'. Both hold with
/// hanging nodes: where interpolation weights are negative (quadratic elements), whose masses go by |w|/σ with
/// σ = Σ|w|, (Σ w v)² ≤ σ² Σ (|w|/σ) v² makes the first larger by σ², and rows by |w| the second by σ. Centred mass damping does not lower
/// the limit; a dashpot (KelvinVoigt), whose rate lags half a step, does: ω² Δt² + 2 c Δt ≤ 4. Of
/// large elements (Hex20, Hex27), eigenvalues are bounded without their matrices, and certain but for 1e-9: see
/// bound_by_products. Throws Error when the state is not finite.
template <class Parts>
double stable_step_of(Parts& parts) {
  if constexpr (!Parts::has_internal_variables) {
    return 2 / std::sqrt(detail::squared_frequency_bound(parts));
  } else {
    auto const bound = [&](double step) {  // of laws that see a time step
      WithStepSize<Parts> const with(parts, step);
      return detail::squared_frequency_bound(parts);
    };
    // At once no branch has relaxed, and no dashpot acts; one of rate c adds 2 c/Δt to Δt/2's stiffness.
    double const at_once = bound(0);
    double step = 2 / std::sqrt(at_once);
    double const dashpots = std::max(bound(step / 2) - at_once, 0.0) * step;
    step = 8 / (dashpots + std::sqrt(dashpots * dashpots + 16 * at_once));
    for (int k = 0; k < 8; ++k) {  // the bounds of sums are not the sums of bounds
      double const excess = bound(step / 2) * step * step / 4;
      if (excess <= 1 + 1e-6) break;
      step /= excess;
    }
    return step;
  }
}

/// The same for an integrator, which looks at sleeping patches no more: of them it knows the bounds from before, and so
/// takes no longer a step while something sleeps. These bounds are part of the state. Where rows gave a step that was clearly
/// the longer, elements are not looked at again within `interval` steps, unless rows fall by half.
template <class Parts>
double awake_stable_step_of(Parts& parts, std::int64_t interval) {
  if constexpr (Parts::has_internal_variables) {
    return stable_step_of(parts);
  } else {
    constexpr double clearly = 1.21;
    auto const before = parts.state.bounds;
    auto& own = parts.state.integrator;
    auto bounds = FrequencyBounds{};
    auto const look = [&](detail::Bounds wanted) {
      bounds = detail::frequency_bounds(parts, detail::Among::awake, wanted);
    };
    bool const by_rows = before.rows > 0 && clearly * before.rows <= before.elements &&
                         parts.state.steps < own.saw_both_at + interval;
    if (by_rows) look(detail::Bounds::of_rows);
    if (!by_rows || 2 * bounds.rows < before.rows) {
      look(detail::Bounds::both);
      own.saw_both_at = parts.state.steps;
    }
    if (parts.awake) {
      bounds.elements = std::max(bounds.elements, before.elements);
      bounds.rows = std::max(bounds.rows, before.rows);
    }
    parts.state.bounds = bounds;
    return 2 / std::sqrt(detail::squared_frequency(parts, bounds));
  }
}

/// The stable step of a body's present state, s: see stable_step_of.
template <DeformableBody TheBody>
double stable_step(TheBody& body) {
  return stable_step_of(body.parts());
}

}  // namespace pliant
