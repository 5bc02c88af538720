#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/body/merged_elements.hpp>
#include <pliant/constraint/rows_on.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/topology/tree_claims.hpp>

// Nodes that went as elements were merged, between nodes that stay, in a backend's memory.
namespace pliant {

namespace detail {

/// The weights that the nodes of a linear element have in the middle between two of them: dyadic numbers, without rounding.
template <Element E>
PLIANT_HOST_DEVICE Vector<double, E::nodes> weights_between(int a, int b) {
  return E::shape(0.5 * (E::cell::corner(a) + E::cell::corner(b)));
}

/// Nodes that went as linear elements were merged. The child in a corner of its parent has the same order of nodes as that, and
/// half its size, so that its node b lies in the middle between the corner and node b of the parent; all of these are there.
template <Element E>
struct GoneBetween {
  static constexpr Index nodes = E::nodes;
  MergedElements<E> families;
  Index const* place;  // by row: of a node that went among these, one more; else 0
  Index* claims;       // by node that went: see tree_claims.hpp
  Index* pair;         // nodes · a + b, of the family whose claim it is
  Index* entries;      // how many weights are not zero

  /// visit(k, a, b) for the nodes that went between nodes a and b of the parent, which k is among them. Some come again.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index r, Visit const& visit_one) const {
    for (int a = 0; a < nodes - 1; ++a) {
      auto child = families.rows_gone(r, a);
      // Mirrored tetrahedra have the nodes of their last two corners in the other order.
      if constexpr (SimplexCell<typename E::cell> && E::dim == 3) {
        auto const at = static_cast<std::size_t>(a);
        if (child[at] != families.rows_come(r, 0)[at]) child = families.rows_gone(r, 5 - a);
      }
      for (int b = a + 1; b < nodes; ++b) {
        Index const k = place[child[static_cast<std::size_t>(b)]] - 1;
        if (k >= 0) visit_one(k, a, b);
      }
    }
  }
};
template <Element E>
struct ClaimGone {
  GoneBetween<E> gone;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    gone.visit(r, [&](Index k, int, int) { claim(gone.claims[k], r, true); });
  }
};
template <Element E>
struct FindPairs {
  GoneBetween<E> gone;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    gone.visit(r, [&](Index k, int a, int b) {
      if (!makes(r, gone.claims[k]) || gone.entries[k] != 0) return;
      auto const weights = weights_between<E>(a, b);
      Index count = 0;
      for (int c = 0; c < E::nodes; ++c) count += weights[c] != 0 ? 1 : 0;
      gone.pair[k] = GoneBetween<E>::nodes * a + b;
      gone.entries[k] = count;
    });
  }
};
template <Element E, class T>
struct PutWeights {
  GoneBetween<E> gone;
  Index const* first;
  Index* other;
  T* weight;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (gone.entries[k] == 0) return;
    auto const parent = gone.families.rows_come(claimant(gone.claims[k]), 0);
    auto const weights = weights_between<E>(gone.pair[k] / GoneBetween<E>::nodes,
                                            gone.pair[k] % GoneBetween<E>::nodes);
    Index to = first[k];
    for (int c = 0; c < E::nodes; ++c) {
      if (weights[c] == 0) continue;
      other[to] = parent[static_cast<std::size_t>(c)];
      weight[to++] = static_cast<T>(weights[c]);
    }
  }
};

/// Notes the places of rows in a list, one more, and that no cell has claimed any.
struct NotePlaces {
  Index const* list;
  Index* place;
  Index* claims;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    place[list[k]] = k + 1;
    claims[k] = -1;
  }
};
struct CountAt {
  Index const* counts;
  PLIANT_HOST_DEVICE Index operator()(Index k) const { return counts[k]; }
};
struct ForgetRows {
  Index const* list;
  Index* place;
  PLIANT_HOST_DEVICE void operator()(Index k) const { place[list[k]] = 0; }
};

}  // namespace detail

/// Finds between which nodes those lay that went in a coarsening, as Transfer::gone has them: as an interpolation, InterpolationOn
/// hands them what these had (see apply_transpose), as Transfer::carry_sums does. Several merged elements may have had one;
/// their weights are the same. Has what passes take between them.
template <Element E, Backend B>
  requires(LinearSimplex<E> || Multilinear<E>)
class GoneNodesOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  explicit GoneNodesOn(B const& backend) : backend_(backend) {}

  /// The nodes that went, by their rows in the order of the list `gone`, (count), in the backend's memory: these had all been
  /// nodes of merged elements. `rows`: how many fields have.
  RowsOn<B> rows(detail::MergedElements<E> const& merged, Index const* gone, Index count,
                 Index rows) {
    RowsOn<B> weights;
    if (count == 0) return weights;
    auto const n = at(count);
    detail::grow_zeroed(backend_, place_, at(rows));
    detail::grow(backend_, claims_, n);
    detail::grow(backend_, pair_, n);
    auto entries = zeros<Index>(backend_, n);
    weights.count = count;
    weights.node = unset<Index>(backend_, n);
    weights.first = unset<Index>(backend_, n + 1);
    detail::copy_values<B, Index>(backend_, gone, weights.node.data(), n);
    backend_.for_each(count, detail::NotePlaces{gone, place_.data(), claims_.data()});
    detail::GoneBetween<E> const between{merged, place_.data(), claims_.data(), pair_.data(),
                                         entries.data()};
    backend_.for_each(merged.count, detail::ClaimGone<E>{between});
    backend_.for_each(merged.count, detail::FindPairs<E>{between});
    backend_.scan(count, detail::CountAt{entries.data()}, weights.first.data());
    auto total = zeros<Index>(backend_, 1);
    backend_.for_each(1, detail::CopyValue<Index>{weights.first.data() + count, total.data()});
    auto const in_all = at(download<Index>(total)[0]);
    weights.other = unset<Index>(backend_, in_all);
    weights.weight = unset<T>(backend_, in_all);
    backend_.for_each(count, detail::PutWeights<E, T>{between, weights.first.data(),
                                                      weights.other.data(), weights.weight.data()});
    backend_.for_each(count, detail::ForgetRows{gone, place_.data()});
    return weights;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  B backend_;
  Array<Index> place_;  // by row: in the list, one more; zero, as between two calls: not there
  Array<Index> claims_, pair_;
};

}  // namespace pliant
