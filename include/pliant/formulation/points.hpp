#pragma once

#include <pliant/formulation/kinematics.hpp>
#include <pliant/quadrature/tensor_rule.hpp>

// Loops over the quadrature points of an element, with the gradients there.
namespace pliant {

namespace detail {

/// A field whose directions from K on are fixed, as polynomials in ξ_0 ... ξ_(K−1), and its slopes along the fixed
/// directions: the steps of sum factorisation (Orszag 1980), from the coefficients to the gradient at a point.
template <TensorElement E, int K, class S>
struct PartlyFixed {
  using T = builtin_scalar<S>;
  static constexpr int dim = E::dim, size = Lattice<E>::size, count = power(size, K);
  S value[count][dim];  // its constant is not used
  S slope[K < dim ? dim - K : 1][count][dim];

  /// What `from`, with one direction more that is free, is where that one is x.
  PLIANT_HOST_DEVICE static PartlyFixed at(Coefficients<E, S> const& from, T x) {
    PartlyFixed next;
    next.fix(from.c, x);
    return next;
  }
  PLIANT_HOST_DEVICE static PartlyFixed at(PartlyFixed<E, K + 1, S> const& from, T x) {
    PartlyFixed next;
    next.fix(from.value, x);
    for (int j = 1; j < dim - K; ++j)
      unroll<count>([&](auto r) PLIANT_INLINE {
        for (int i = 0; i < dim; ++i) next.slope[j][r][i] = value_at<r>(from.slope[j - 1], i, x);
      });
    return next;
  }
  /// Two directions fixed at once, where shape functions are linear: with less between the coefficients and the line.
  PLIANT_HOST_DEVICE static PartlyFixed at(Coefficients<E, S> const& from, Vector<T, 2> const& x)
    requires(K == 1 && size == 2 && dim == 3)
  {
    PartlyFixed line;
    auto const& c = from.c;
    for (int i = 0; i < dim; ++i) {
      line.slope[0][0][i] = c[2][i] + x[1] * c[6][i];
      line.slope[0][1][i] = c[3][i] + x[1] * c[7][i];
      line.slope[1][0][i] = c[4][i] + x[0] * c[6][i];
      line.slope[1][1][i] = c[5][i] + x[0] * c[7][i];
      line.value[1][i] = c[1][i] + x[0] * c[3][i] + x[1] * line.slope[1][1][i];
    }
    return line;
  }
  PLIANT_HOST_DEVICE Tensor<S, dim> gradient() const {
    static_assert(K == 0);
    Tensor<S, dim> g;
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) g(i, k) = slope[k][0][i];
    return g;
  }

  /// The transposes.
  PLIANT_HOST_DEVICE static PartlyFixed zero() {
    PartlyFixed none;
    for (auto& row : none.value)
      for (S& x : row) x = S(0);
    for (auto& rows : none.slope)
      for (auto& row : rows)
        for (S& x : row) x = S(0);
    return none;
  }
  PLIANT_HOST_DEVICE static PartlyFixed of(Tensor<S, dim> const& flux) {
    static_assert(K == 0);
    auto point = zero();
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) point.slope[k][0][i] = flux(i, k);
    return point;
  }
  PLIANT_HOST_DEVICE void add_to(Coefficients<E, S>& to, T x) const { release(to.c, x); }
  PLIANT_HOST_DEVICE void add_to(Coefficients<E, S>& to, Vector<T, 2> const& x) const
    requires(K == 1 && size == 2 && dim == 3)
  {
    for (int i = 0; i < dim; ++i) {
      auto const add = [&](int b, S const& v) PLIANT_INLINE { to.c[b][i] = to.c[b][i] + v; };
      S const high = slope[1][1][i] + x[1] * value[1][i];
      add(1, value[1][i]);
      add(2, slope[0][0][i]);
      add(3, slope[0][1][i] + x[0] * value[1][i]);
      add(4, slope[1][0][i]);
      add(5, high);
      add(6, x[1] * slope[0][0][i] + x[0] * slope[1][0][i]);
      add(7, x[1] * slope[0][1][i] + x[0] * high);
    }
  }
  PLIANT_HOST_DEVICE void add_to(PartlyFixed<E, K + 1, S>& to, T x) const {
    release(to.value, x);
    for (int j = 1; j < dim - K; ++j)
      unroll<count>([&](auto r) PLIANT_INLINE {
        for (int i = 0; i < dim; ++i) add_value<r>(to.slope[j - 1], i, x, slope[j][r][i]);
      });
  }

 private:
  using More = S[count * size][dim];

  template <int R>
  PLIANT_HOST_DEVICE static S value_at(More const& from, int i, T x) {
    if constexpr (size == 2)
      return from[R][i] + x * from[R + count][i];
    else
      return from[R][i] + x * (from[R + count][i] + x * from[R + 2 * count][i]);
  }
  template <int R>
  PLIANT_HOST_DEVICE static void add_value(More& to, int i, T x, S const& v) {
    S const xv = x * v;
    to[R][i] = to[R][i] + v;
    to[R + count][i] = to[R + count][i] + xv;
    if constexpr (size == 3) to[R + 2 * count][i] = to[R + 2 * count][i] + x * xv;
  }
  PLIANT_HOST_DEVICE void fix(More const& from, T x) {
    unroll<count>([&](auto r) PLIANT_INLINE {
      for (int i = 0; i < dim; ++i) {
        if constexpr (r > 0) value[r][i] = value_at<r>(from, i, x);
        if constexpr (size == 2)
          slope[0][r][i] = from[r + count][i];
        else
          slope[0][r][i] = from[r + count][i] + (x + x) * from[r + 2 * count][i];
      }
    });
  }
  PLIANT_HOST_DEVICE void release(More& to, T x) const {
    unroll<count>([&](auto r) PLIANT_INLINE {
      for (int i = 0; i < dim; ++i) {
        if constexpr (r > 0) add_value<r>(to, i, x, value[r][i]);
        to[r + count][i] = to[r + count][i] + slope[0][r][i];
        if constexpr (size == 3)
          to[r + 2 * count][i] = to[r + 2 * count][i] + (x + x) * slope[0][r][i];
      }
    });
  }
};

template <int K, class X, Element E, class S>
PLIANT_HOST_DEVICE auto fixed_at(Coefficients<E, S> const& from, X const& x) {
  return PartlyFixed<E, K, S>::at(from, x);
}
template <int K, class X, Element E, class S>
PLIANT_HOST_DEVICE auto fixed_at(PartlyFixed<E, K + 1, S> const& from, X const& x) {
  return PartlyFixed<E, K, S>::at(from, x);
}

/// How many directions are free after a step from K.
template <Element E, int K>
inline constexpr int next_free = E::degree == 1 && K == 3 ? 1 : K - 1;
/// The places of step p.
template <Element E, int K, class Rule>
PLIANT_HOST_DEVICE auto places_at(Rule const& rule, int p) {
  if constexpr (K - next_free<E, K> == 1)
    return rule.place[p];
  else
    return Vector<std::remove_cvref_t<decltype(rule.place[0])>, 2>{
        {{rule.place[p % Rule::count]}, {rule.place[p / Rule::count]}}};
}

/// Whether a loop over the steps from K stays one: what compilers unroll of large bodies does not fit the caches of
/// instructions, takes registers, and takes long to compile. (Swept by bench/formulation.)
template <Element E, int K, class T, int Fields>
#if defined(__CUDACC__)
inline constexpr bool loops = E::degree > 1 ||
                              (E::dim == 3 && K > 1 && (sizeof(T) == 4 || Fields > 2));
#else
inline constexpr bool loops = E::degree > 1 && K == E::dim;
#endif

/// Calls f(p, q) for the steps p from K, with the first point of each.
template <Element E, int K, int Fields, class Rule, class F>
PLIANT_HOST_DEVICE void for_each_step(int first, F const& f) {
  constexpr int steps = power(Rule::count, K - next_free<E, K>);
  constexpr bool loop = loops<E, K, typename Rule::scalar, Fields>;
  int const count = loop ? unknown(steps) : steps;
#if defined(__CUDA_ARCH__)
#pragma unroll(loop ? 1 : steps)
#endif
  for (int p = 0; p < count; ++p) f(p, first + p * power(Rule::count, next_free<E, K>));
}

/// visit(q, weight, gradients...) at the points of a product rule, where the directions from K on are fixed.
template <Element E, int K, class Rule, class Visit, class... Fields>
PLIANT_HOST_DEVICE void visit_lines(Rule const& rule, int first, Visit const& visit,
                                    Fields const&... fields) {
  constexpr int free = next_free<E, K>;
  for_each_step<E, K, sizeof...(Fields), Rule>(first, [&](int p, int q) PLIANT_INLINE {
    auto const x = places_at<E, K>(rule, p);
    [&](auto const&... fixed) PLIANT_INLINE {
      if constexpr (free == 0)
        visit(q, rule.weight[q], fixed.gradient()...);
      else
        visit_lines<E, free>(rule, q, visit, fixed...);
    }(fixed_at<free>(fields, x)...);
  });
}
/// Adds what flux(q, weight, gradients...) gives to the sum, as a divergence.
template <Element E, class S, int K, class Rule, class Flux, class Sum, class... Fields>
PLIANT_HOST_DEVICE void add_lines(Rule const& rule, int first, Flux const& flux, Sum& sum,
                                  Fields const&... fields) {
  constexpr int free = next_free<E, K>;
  using Part = PartlyFixed<E, free, S>;
  for_each_step<E, K, sizeof...(Fields), Rule>(first, [&](int p, int q) PLIANT_INLINE {
    auto const x = places_at<E, K>(rule, p);
    [&](auto const&... fixed) PLIANT_INLINE {
      if constexpr (free == 0) {
        Part::of(flux(q, rule.weight[q], fixed.gradient()...)).add_to(sum, x);
      } else {
        auto part = Part::zero();
        add_lines<E, S, free>(rule, q, flux, part, fixed...);
        part.add_to(sum, x);
      }
    }(fixed_at<free>(fields, x)...);
  });
}

/// Whether sums over points go direction by direction.
template <Element E, class Q>
inline constexpr bool by_direction = TensorElement<E> && is_tensor_rule<Q, typename E::cell>;

}  // namespace detail

/// Calls visit(q, weight, map, ∂v/∂X...) at each point of the rule Q, for fields v... on an element with positions x at rest.
template <class Q, Geometry G = Geometry::isoparametric, Element E, class S, class Visit,
          class... V>
PLIANT_HOST_DEVICE void visit_points(Visit const& visit, Coefficients<E, S> const& x,
                                     V const&... v) {
  using T = builtin_scalar<S>;
  if constexpr (detail::by_direction<E, Q>) {
    static constexpr auto rule = ProductRule<Q, typename E::cell, T>::make();
    detail::visit_lines<E, E::dim>(
        rule, 0,
        [&](int q, T weight, auto const& j, auto const&... slopes) PLIANT_INLINE {
          auto const map = RestMap<E, S, G>::of(j);
          visit(q, weight, map, map.gradient(slopes)...);
        },
        x, v...);
  } else {
    static constexpr auto table = tabulate<E, Q, T>();
    for (int q = 0; q < table.count; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      visit(q, T(table.weight[q]), map, map.gradient(v, table, q)...);
    }
  }
}

/// Adds Σ_k t_ik ∂N_a/∂ξ_k of the tensors t = flux(q, weight, map, ∂v/∂X...) at all points of the rule Q to f.
template <class Q, Geometry G = Geometry::isoparametric, Element E, class S, class Flux, class... V>
PLIANT_HOST_DEVICE void add_divergences(Coefficients<E, S>& f, Flux const& flux,
                                        Coefficients<E, S> const& x, V const&... v) {
  using T = builtin_scalar<S>;
  if constexpr (detail::by_direction<E, Q>) {
    static constexpr auto rule = ProductRule<Q, typename E::cell, T>::make();
    detail::add_lines<E, S, E::dim>(
        rule, 0,
        [&](int q, T weight, auto const& j, auto const&... slopes) PLIANT_INLINE {
          auto const map = RestMap<E, S, G>::of(j);
          return flux(q, weight, map, map.gradient(slopes)...);
        },
        f, x, v...);
  } else {
    static constexpr auto table = tabulate<E, Q, T>();
    for (int q = 0; q < table.count; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      f.add_divergence(flux(q, T(table.weight[q]), map, map.gradient(v, table, q)...), table, q);
    }
  }
}

}  // namespace pliant
