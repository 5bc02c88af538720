#pragma once

#include <pliant/backend/backend.hpp>
#include <pliant/backend/is_marked.hpp>
#include <pliant/body/group_laws.hpp>
#include <pliant/formulation/one_gradient.hpp>
#include <pliant/formulation/point_kernel.hpp>

// The adapters between the element loops of a backend, which speak of group numbers and gathered
// values, and the physics of a formulation.
namespace pliant {

namespace detail {
/// The points of a formulation whose forces are the divergence of a flux; void for others.
template <class F, Geometry How>
using PointsOfFormulation =
    std::conditional_t<std::same_as<SchemeOf<F, How>, Pointwise<F, How>>,
                       PointsOf<typename F::element, typename F::quadrature>, void>;

/// The flux of a formulation at point q from the slopes ∂v_i/∂ξ_k of the positions at rest and of other fields.
template <class F, Geometry How, class L, class T, class S, class... V>
PLIANT_HOST_DEVICE auto flux_from_slopes(L const& law, int q, T weight, S const& j,
                                         V const&... slopes) {
  auto const map = RestMap<typename F::element, T, How>::of(j);
  return Pointwise<F, How>::flux(law, q, weight, map, map.gradient(slopes)...);
}
}  // namespace detail

/// −∂W/∂u of an element, (nodes, dim), N.
template <class Laws, Geometry How = Geometry::isoparametric>
struct ForceKernel {
  static constexpr bool reads_elements = Laws::reads_elements;
  static constexpr bool few_operations = Laws::few_operations;
  static constexpr bool symmetric = Laws::symmetric;
  Laws groups;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          return force<typename Laws::template formulation<G>, How>(law, rest, u);
        },
        v...);
  }
  template <int G>
  using points = detail::PointsOfFormulation<typename Laws::template formulation<G>, How>;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto flux(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [](auto const& law, auto const&... at) PLIANT_INLINE {
          return detail::flux_from_slopes<typename Laws::template formulation<G>, How>(law, at...);
        },
        v...);
  }
};

/// Adds factor · ∂F/∂u · du.
template <class T, class Laws, Geometry How = Geometry::isoparametric>
struct TangentKernel {
  static constexpr bool reads_elements = Laws::reads_elements;
  static constexpr bool symmetric = Laws::symmetric;
  Laws groups;
  T factor;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u, auto const& du) PLIANT_INLINE {
          return factor *
                 tangent_product<typename Laws::template formulation<G>, How>(law, rest, u, du);
        },
        v...);
  }
  template <int G>
  using points = detail::PointsOfFormulation<typename Laws::template formulation<G>, How>;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto flux(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const&... at) PLIANT_INLINE {
          return factor *
                 detail::flux_from_slopes<typename Laws::template formulation<G>, How>(law, at...);
        },
        v...);
  }
};

/// The strain energy of an element, J.
template <class Laws, Geometry How = Geometry::isoparametric>
struct EnergyKernel {
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          return energy<typename Laws::template formulation<G>, How>(law, rest, u);
        },
        v...);
  }
};

/// Row sums Σ_j |K_ij| of an element's stiffness, per node and direction.
template <class Laws>
struct RowSumKernel {
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  detail::HasMarkedNode<Laws::template formulation<0>::nodes>
      has_marked{};  // where not all are asked for

  PLIANT_HOST_DEVICE bool selects(Index e, Tag) const {
    return has_marked.marks == nullptr || has_marked(e);
  }
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    using F = typename Laws::template formulation<G>;
    return groups.template apply<G>(
        [](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          if constexpr (has_one_gradient<F>)
            return one_gradient<F>(law, rest, u).row_sums();
          else
            return by_columns<F>(law, rest, u);
        },
        v...);
  }

 private:
  template <class F, class Law, class Values>
  PLIANT_HOST_DEVICE static Values by_columns(Law const& law, Values const& rest, Values const& u) {
    constexpr int dim = F::dim, size = F::nodes * dim;
    auto rows = Values::zero();
    auto const add = [&](int row, auto const& entry) PLIANT_INLINE {
      rows(row / dim, row % dim) = rows(row / dim, row % dim) + abs(entry);
    };
    if constexpr (has_large_stiffness<F>) {
      for (int column = 0; column < size; ++column) {
        auto du = Values::zero();
        du(column / dim, column % dim) = du(column / dim, column % dim) + 1;
        auto const df = tangent_product<F>(law, rest, u, du);
        for (int row = 0; row < size; ++row) add(row, df(row / dim, row % dim));
      }
    } else {
      auto const k = stiffness<F>(law, rest, u);
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) add(row, k(row, column));
    }
    return rows;
  }
};

/// Column `column` of each node's own block of an element's stiffness.
template <class Laws>
struct DiagonalKernel {
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  int column;
  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    using F = typename Laws::template formulation<G>;
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          auto blocks = std::remove_cvref_t<decltype(u)>::zero();
          for (int a = 0; a < F::nodes; ++a) {
            auto du = std::remove_cvref_t<decltype(u)>::zero();
            du(a, column) = du(a, column) + 1;
            auto const df = tangent_product<F>(law, rest, u, du);
            for (int i = 0; i < F::dim; ++i) blocks(a, i) = -df(a, i);
          }
          return blocks;
        },
        v...);
  }
};

}  // namespace pliant
