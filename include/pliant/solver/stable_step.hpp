#pragma once

#include <cmath>
#include <limits>

#include <pliant/body/body.hpp>

namespace pliant {

namespace detail {

/// Row sums Σ_j |K_ij| of an element's stiffness, per node and direction.
template <class Laws>
struct StiffnessRows {
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    using F = typename Laws::template formulation<G>;
    return groups.template apply<G>(
        [](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          auto const k = stiffness<F>(law, rest, u);
          auto rows = std::remove_cvref_t<decltype(u)>::zero();
          for (int i = 0; i < F::nodes * F::dim; ++i)
            for (int j = 0; j < F::nodes * F::dim; ++j)
              rows(i / F::dim, i % F::dim) = rows(i / F::dim, i % F::dim) + abs(k(i, j));
          return rows;
        },
        v...);
  }
};

/// An upper bound of the largest |eigenvalue| of a symmetric matrix, within a factor N^(1/8): the
/// Frobenius norm ‖A⁴‖^(1/4), computed from A scaled to norm one.
template <class S, int N>
PLIANT_HOST_DEVICE S spectral_bound(Tensor<S, N> a) {
  S largest = S(0);
  for (int i = 0; i < N; ++i) {
    S row = S(0);
    for (int j = 0; j < N; ++j) row = row + abs(a(i, j));
    largest = max(largest, row);
  }
  using T = builtin_scalar<S>;
  S const scale = S(1) / max(largest, S(std::numeric_limits<T>::min()));
  a = scale * a;
  for (int power = 0; power < 2; ++power) {
    Tensor<S, N> squared;
    for (int i = 0; i < N; ++i)
      for (int j = i; j < N; ++j) {
        S sum = S(0);
        for (int k = 0; k < N; ++k) sum = sum + a(i, k) * a(j, k);
        squared(i, j) = sum;
        squared(j, i) = sum;
      }
    a = squared;
  }
  return largest * sqrt(sqrt(norm(a)));
}

/// Writes a bound of the largest eigenvalue of M_e⁻¹ K_e, 1/s², for each element.
template <class T, class Laws>
struct ElementSpectra {
  static constexpr int counters = 1;
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  T density;
  T* bound;  // (elements)

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    using F = typename Laws::template formulation<G>;
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          using S = std::remove_cvref_t<decltype(rest(0, 0))>;
          auto k = stiffness<F>(law, rest, u);
          auto const volumes = nodal_volumes<typename F::element>(rest);
          Vector<S, F::nodes> scale;
          for (int a = 0; a < F::nodes; ++a) scale[a] = S(1) / sqrt(density * volumes[a]);
          for (int i = 0; i < F::nodes * F::dim; ++i)
            for (int j = 0; j < F::nodes * F::dim; ++j)
              k(i, j) = k(i, j) * scale[i / F::dim] * scale[j / F::dim];
          Vector<S, 1> result;
          result[0] = spectral_bound(k);
          return result;
        },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    bound[e] = value[0];
  }
};

/// A number that is not one must not get lost in a maximum.
PLIANT_HOST_DEVICE double infinite_if_not_finite(double x) {
  return x <= std::numeric_limits<double>::max() ? x : std::numeric_limits<double>::infinity();
}

template <class T>
struct ValueAt {
  T const* data;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return infinite_if_not_finite(static_cast<double>(data[i]));
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

/// An upper bound of ω², 1/s².
template <class TheBody>
double squared_frequency_bound(TheBody& body) {
  using T = typename TheBody::scalar;
  using B = typename TheBody::backend_type;
  constexpr int dim = TheBody::dim;
  B const& backend = body.backend();
  auto& layout = body.layout();
  typename B::template Array<T> rows(layout.f.size());
  double by_elements = 0;
  std::as_const(body).for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0) return;
    using Laws = typename Table::Laws;
    auto const u = std::as_const(body).displacement_field();
    backend.template accumulate<Table::groups>(
        table.elements, detail::StiffnessRows<Laws>{table.laws}, NodeField<T, dim>{rows.data()},
        body.rest_field(), u);
    typename B::template Array<T> bounds(static_cast<std::size_t>(table.count()));
    typename B::template Array<double> counters(1);
    backend.template visit<Table::groups>(
        table.elements,
        detail::ElementSpectra<T, Laws>{table.laws, static_cast<T>(body.material().density),
                                        bounds.data()},
        counters, body.rest_field(), u);
    by_elements =
        std::max(by_elements, backend.maximum(table.count(), detail::ValueAt<T>{bounds.data()}));
  });
  layout.slaves.hand_to_masters(backend, NodeField<T, dim>{rows.data()});
  double const by_rows = backend.maximum(
      layout.nodes,
      detail::RowOverMass<T, dim>{{rows.data()}, layout.mass.data(), layout.held.data()});
  double const eigenvalue = std::min(by_elements, by_rows);
  if (!std::isfinite(eigenvalue) || !(eigenvalue > 0))
    throw Error("stable_step: the stiffness of the body is ",
                eigenvalue > 0 ? "not finite" : "zero", " at time ", body.time(),
                " s; an element has collapsed, or every node is held");
  return eigenvalue;
}

/// Laws see another time step for as long as this lives.
template <class TheBody>
class WithStepSize {
 public:
  WithStepSize(TheBody& body, double step) : body_(body), before_(body.step_size()) {
    body.set_step_size(step);
  }
  WithStepSize(WithStepSize const&) = delete;
  ~WithStepSize() { body_.set_step_size(before_); }

 private:
  TheBody& body_;
  double before_;
};

}  // namespace detail

/// A time step, s, below which central differences are certain to be stable for the body frozen in
/// its present state: 2/ω with ω² bounded in two ways, of which the better is taken. Either by the
/// largest element eigenvalue of M_e⁻¹ K_e (Irons and Treharne 1971), or by unassembled Gershgorin
/// discs, max_i Σ_e Σ_j |K_e,ij| / m_i, rows of slaves added to their masters'. Both hold with
/// hanging nodes, whose interpolation weights are not negative. Centred mass damping does not lower
/// the limit; a dashpot (KelvinVoigt), whose rate lags half a step, does: ω² Δt² + 2 c Δt ≤ 4. Throws
/// Error when the state is not finite.
template <class TheBody>
double stable_step(TheBody& body) {
  if constexpr (!TheBody::has_internal_variables) {
    return 2 / std::sqrt(detail::squared_frequency_bound(body));
  } else {
    auto const bound = [&](double step) {  // of laws that see a time step
      detail::WithStepSize const with(body, step);
      return detail::squared_frequency_bound(body);
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

}  // namespace pliant
