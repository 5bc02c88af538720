#pragma once

#include <cstring>
#include <type_traits>

#include <pliant/backend/elements_of_rows.hpp>

#include "body/refined_mesh.hpp"
#include "support/backends.hpp"

// Loops over elements by which tests compare two tables of the same elements.
namespace pliant::test {

/// Springs between all nodes of an element, of twice the stiffness in group 1.
template <int Nodes, int Dim>
struct SpringForce {
  static constexpr bool symmetric = true;
  template <int G, class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    V out = x;
    for (int k = 0; k < Dim; ++k) {
      auto sum = x(0, k);
      for (int a = 1; a < Nodes; ++a) sum = sum + x(a, k);
      for (int a = 0; a < Nodes; ++a) out(a, k) = S(G + 1) * (S(Nodes) * x(a, k) - sum);
    }
    return out;
  }
};
/// Weighs nodes by their places, so that no two orders of them give the same.
template <int Nodes, int Dim>
struct WeightedSquares {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    S sum = S(0);
    for (int k = 0; k < Dim; ++k)
      for (int a = 0; a < Nodes; ++a) sum = sum + S(G + 1) * S(a + 1) * x(a, k) * x(a, k);
    return sum;
  }
};

/// 1 for an element of a group, and 0 for others.
template <int Wanted>
struct IsInGroup {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& x) const {
    using S = std::remove_cvref_t<decltype(x(0, 0))>;
    return S(G == Wanted ? 1 : 0);
  }
};

#if defined(__CUDACC__)
static_assert(TakesRows<CudaElements<double, 10>, Cuda<double>>);

template <class B, class View>
bool same_patches(B const& backend, View const& one, View const& other, Index patches,
                  Index units) {
  auto const same = [&](auto const* a, auto const* b, Index count) {
    if ((a == nullptr) != (b == nullptr)) return false;
    if (a == nullptr) return true;
    auto const x = taken(backend, a, count), y = taken(backend, b, count);
    return std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return one.capacity.nodes == other.capacity.nodes && one.capacity.fans == other.capacity.fans &&
         one.capacity.slots == other.capacity.slots &&
         one.capacity.diagonals == other.capacity.diagonals &&
         same(one.units, other.units, units) &&
         same(one.nodes, other.nodes, patches * one.capacity.nodes) &&
         same(one.diagonals, other.diagonals, patches * one.capacity.diagonals);
}
#endif

}  // namespace pliant::test
