#pragma once

#include <pliant/formulation/physics.hpp>
#include <pliant/formulation/point_stiffness.hpp>
#include <pliant/math/unroll.hpp>

// The stiffness of elements that look at one gradient, without its matrix.
namespace pliant {

/// Whether an element looks at one gradient of displacements, at one point: Tri3 and Tet4 with Gauss<1>.
template <class F>
inline constexpr bool has_one_gradient = F::points == 1 && F::nodes == F::dim + 1 &&
                                         std::same_as<detail::SchemeOf<F, Geometry::isoparametric>,
                                                      Pointwise<F, Geometry::isoparametric>>;

/// Such an element: K_(ai)(bk) = Σ_jl g_ja A_ijkl g_lb with g = det J ∂N/∂X and A = w ∂P/∂H / det J.
template <class F, class L, class S>
  requires has_one_gradient<F>
class OneGradient {
  using E = typename F::element;
  static constexpr int dim = F::dim, nodes = F::nodes;

 public:
  PLIANT_HOST_DEVICE OneGradient(L const& law, Nodal<E, S> const& rest, Nodal<E, S> const& u)
      : law_(law) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const map = RestMap<E, S>::at(Coefficients<E, S>::of(rest), table, 0);
    h_ = map.gradient(Coefficients<E, S>::of(u), table, 0);
    gradient_ = detail::rest_gradients<E>(map, table, 0);
    weight_ = map.inverse_volume * T(table.weight[0]);
  }

  /// Row sums Σ_bk |K_(ai)(bk)|.
  [[nodiscard]] PLIANT_HOST_DEVICE Nodal<E, S> row_sums() const {
    auto rows = Nodal<E, S>::zero();
    repeat<dim>([&](int k) PLIANT_INLINE {
      Tensor<S, dim> tangent[dim];  // of the gradient's entries (k, l)
      repeat<dim>([&](int l) PLIANT_INLINE {
        auto dh = Tensor<S, dim>::zero();
        dh(k, l) = weight_;
        tangent[l] = change(dh);
      });
      repeat<nodes>([&](int b) PLIANT_INLINE {
        auto pull = gradient_(0, b) * tangent[0];
        for (int l = 1; l < dim; ++l) pull = pull + gradient_(l, b) * tangent[l];
        for (int a = 0; a < nodes; ++a)
          for (int i = 0; i < dim; ++i) {
            S sum = pull(i, 0) * gradient_(0, a);
            for (int j = 1; j < dim; ++j) sum = sum + pull(i, j) * gradient_(j, a);
            rows(a, i) = rows(a, i) + abs(sum);
          }
      });
    });
    return rows;
  }

  /// A symmetric matrix with the eigenvalues of `factor` K but for zeros: ℓᵀ A ℓ with ℓ ℓᵀ = factor g gᵀ.
  /// Since Σ_a g_a = 0, ℓ is g in an orthonormal basis of what has no sum over nodes (Helmert's).
  [[nodiscard]] PLIANT_HOST_DEVICE Tensor<S, dim * dim> of_gradients(S const& factor) const {
    using T = builtin_scalar<S>;
    Tensor<S, dim> lengths;
    for (int j = 0; j < dim; ++j) {
      S before = gradient_(j, 0);
      for (int p = 0; p < dim; ++p) {
        T const size = T(1) / sqrt(T((p + 1) * (p + 2)));
        lengths(j, p) = size * (before - T(p + 1) * gradient_(j, p + 1));
        before = before + gradient_(j, p + 1);
      }
    }
    Tensor<S, dim * dim> k;
    S const weight = factor * weight_;
    repeat<dim * dim>([&](int column) PLIANT_INLINE {
      auto dh = Tensor<S, dim>::zero();
      for (int l = 0; l < dim; ++l) dh(column / dim, l) = weight * lengths(l, column % dim);
      auto const pull = change(dh);
      for (int row = 0; row <= column; ++row) {
        S sum = pull(row / dim, 0) * lengths(0, row % dim);
        for (int j = 1; j < dim; ++j) sum = sum + pull(row / dim, j) * lengths(j, row % dim);
        k(row, column) = k(column, row) = sum;
      }
    });
    return k;
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE Tensor<S, dim> change(Tensor<S, dim> const& dh) const {
    return stress_tangent_product(at_point(law_, 0), h_, dh);
  }

  L const& law_;
  Tensor<S, dim> h_;
  Matrix<S, dim, nodes> gradient_;
  S weight_;
};
template <class F, class L, class S>
PLIANT_HOST_DEVICE OneGradient<F, L, S> one_gradient(L const& law,
                                                     Nodal<typename F::element, S> const& rest,
                                                     Nodal<typename F::element, S> const& u) {
  return {law, rest, u};
}

}  // namespace pliant
