#pragma once

#include <cstddef>
#include <tuple>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/body/converted_elements_on.hpp>
#include <pliant/body/merged_elements.hpp>
#include <pliant/constraint/rows_on.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/patterns.hpp>
#include <pliant/topology/tree_claims.hpp>

// Nodes that went as elements were merged, or lowered, between nodes that stay, in a backend's memory.
namespace pliant {

namespace detail {

/// Where the nodes of elements that go lie on the one that comes: those of children on their parent's element, (2: whether the parent
/// is mirrored, children, nodes); children of other types have none but those of these.
template <Element E>
std::vector<Vector<double, E::dim>> places_of_gone(MergedElements<E> const&) {
  auto const& pattern = pattern_of(kind_of<typename E::cell>, Division::refined);
  std::vector<Vector<double, E::dim>> places;
  for (bool const mirrored : {false, true})
    for (int child = 0; child < pattern.children; ++child) {
      if (pattern.child_kind[static_cast<std::size_t>(child)] != kind_of<typename E::cell>) break;
      for (int a = 0; a < E::nodes; ++a)
        places.push_back(on_parent<typename E::cell>(E::place(a), pattern, child, mirrored));
    }
  return places;
}

/// Those of lowered elements: (nodes). Those of elements into which one was split around a node, (children, nodes): only that one
/// goes, and none from pyramids.
template <Element From, Element To>
std::vector<Vector<double, From::dim>> places_of_gone(ConvertedElements<From, To> const&) {
  std::vector<Vector<double, From::dim>> places;
  if constexpr (std::same_as<SplitInto<To>, From> && !std::same_as<To, Pyramid5>) {
    auto const& pattern =
        pattern_of(kind_of<typename To::cell>,
                   To::dim == 2 ? Division::four_triangles : Division::six_pyramids);
    for (int child = 0; child < pattern.children; ++child)
      for (int a = 0; a < From::nodes; ++a)
        places.push_back(on_parent<typename From::cell>(From::place(a), pattern, child));
  } else {
    for (int a = 0; a < From::nodes; ++a) places.push_back(From::place(a));
  }
  return places;
}

/// Nodes that went with elements of families of which one came; those of that one are all there.
template <ChangedFamilies Families>
struct GoneBetween {
  using Gone = typename Families::gone_element;
  using Come = typename Families::come_element;
  Families families;
  Vector<double, Come::dim> const* places;  // see places_of_gone
  Index const* place;  // by row: of a node that went among these, one more; else 0
  Index* claims;       // by node that went: see tree_claims.hpp
  Index* from;         // where it lies on the parent of the family whose claim it is, of `places`
  Index* entries;      // how many weights are not zero

  /// visit(k, from) for the nodes that went of a family, which k is among them. Some come again.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index r, Visit const& visit_one) const {
    Index const children = families.gone(r);
    if (children == 0) return;
    Index next = is_mirrored(r) ? Families::most_gone * Gone::nodes : 0;
    for (Index child = 0; child < children; ++child)
      for (Index const row : families.rows_gone(r, child)) {
        if (Index const k = place[row] - 1; k >= 0) visit_one(k, next);
        ++next;
      }
  }
  /// The weights that the nodes of the parent have there: dyadic numbers, without rounding.
  [[nodiscard]] PLIANT_HOST_DEVICE Vector<double, Come::nodes> weights(Index k) const {
    return Come::shape(places[from[k]]);
  }

 private:
  /// Mirrored tetrahedra have their last two corners in the other order, and other children there.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_mirrored(Index r) const {
    if constexpr (Families::most_gone > 1 && SimplexCell<typename Come::cell> && Come::dim == 3)
      return families.rows_gone(r, 2)[2] != families.rows_come(r, 0)[2];
    return false;
  }
};
template <class Families>
struct ClaimGone {
  GoneBetween<Families> gone;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    gone.visit(r, [&](Index k, Index) { claim(gone.claims[k], r, true); });
  }
};
template <class Families>
struct FindOnParents {
  GoneBetween<Families> gone;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    gone.visit(r, [&](Index k, Index from) {
      if (!makes(r, gone.claims[k]) || gone.entries[k] != 0) return;
      gone.from[k] = from;
      auto const weights = gone.weights(k);
      Index count = 0;
      for (int c = 0; c < Families::come_element::nodes; ++c) count += weights[c] != 0 ? 1 : 0;
      gone.entries[k] = count;
    });
  }
};
template <class Families, class T>
struct PutWeights {
  GoneBetween<Families> gone;
  Index const* first;
  Index* other;
  T* weight;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const family = claimant(gone.claims[k]);
    if (gone.entries[k] == 0 || gone.families.come(family) == 0) return;
    auto const parent = gone.families.rows_come(family, 0);
    auto const weights = gone.weights(k);
    Index to = first[k];
    for (int c = 0; c < Families::come_element::nodes; ++c) {
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

/// Finds between which nodes those lay that went in a change, as Transfer::gone has them: as an interpolation, InterpolationOn
/// hands them what these had (see apply_transpose), as Transfer::carry_sums does. Several elements may have had one; their weights
/// are the same. Has what passes take between them.
template <Backend B>
class GoneNodesOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  explicit GoneNodesOn(B const& backend) : backend_(backend) {}

  /// The nodes that went, by their rows in the order of the list `gone`, (count), in the backend's memory: these had all been
  /// nodes of elements of the families. `rows`: how many fields have.
  template <detail::ChangedFamilies... Families>
  RowsOn<B> rows(Index const* gone, Index count, Index rows, Families const&... families) {
    RowsOn<B> weights;
    if (count == 0) return weights;
    auto const n = at(count);
    detail::grow_zeroed(backend_, place_, at(rows));
    detail::grow(backend_, claims_, n);
    detail::grow(backend_, from_, n);
    auto entries = zeros<Index>(backend_, n);
    weights.count = count;
    weights.node = unset<Index>(backend_, n);
    weights.first = unset<Index>(backend_, n + 1);
    detail::copy_values<B, Index>(backend_, gone, weights.node.data(), n);
    backend_.for_each(count, detail::NotePlaces{gone, place_.data(), claims_.data()});
    std::tuple const places{upload(backend_, detail::places_of_gone(families))...};
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      std::tuple const between{detail::GoneBetween<Families>{families, std::get<I>(places).data(),
                                                             place_.data(), claims_.data(),
                                                             from_.data(), entries.data()}...};
      (backend_.for_each(families.count, detail::ClaimGone<Families>{std::get<I>(between)}), ...);
      (backend_.for_each(families.count, detail::FindOnParents<Families>{std::get<I>(between)}),
       ...);
      backend_.scan(count, detail::CountAt{entries.data()}, weights.first.data());
      auto total = zeros<Index>(backend_, 1);
      backend_.for_each(1, detail::CopyValue<Index>{weights.first.data() + count, total.data()});
      auto const in_all = at(download<Index>(total)[0]);
      weights.other = unset<Index>(backend_, in_all);
      weights.weight = unset<T>(backend_, in_all);
      (backend_.for_each(
           count, detail::PutWeights<Families, T>{std::get<I>(between), weights.first.data(),
                                                  weights.other.data(), weights.weight.data()}),
       ...);
    }(std::index_sequence_for<Families...>());
    backend_.for_each(count, detail::ForgetRows{gone, place_.data()});
    return weights;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  B backend_;
  Array<Index> place_;  // by row: in the list, one more; zero, as between two calls: not there
  Array<Index> claims_, from_;
};

}  // namespace pliant
