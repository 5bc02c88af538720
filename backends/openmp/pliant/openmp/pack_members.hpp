#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include <pliant/backend/dispatch.hpp>
#include <pliant/backend/field.hpp>
#include <pliant/backend/kernel.hpp>
#include <pliant/openmp/patches.hpp>
#include <pliant/openmp/transpose.hpp>

// Elements of a patch, as many at a time as a pack has lanes.
namespace pliant::detail {

/// The elements in the lanes of one pack; behind `count` the last one repeats.
template <class T>
struct PackMembers {
  using Scalar = Pack<T>;
  Index element[Scalar::lanes];
  int count;
  Index patch, first;                   // the patch that has them, and its first element
  std::span<std::uint16_t const> next;  // of the patch: the elements of the pack that follows

  /// The values of a field per element.
  template <class U, int C>
  Vector<Scalar, C> operator()(ElementField<U, C> const& field) const {
    Vector<Scalar, C> values;
    for (int k = 0; k < C; ++k)
      for (int l = 0; l < Scalar::lanes; ++l) values[k].v[l] = field(element[l], k);
    return values;
  }
};

/// f(GroupNumber<Group>{}, members) for each pack of those of a patch with which `functor`, a kernel or a visitor, has to do.
template <int Group, class T, int Nodes, class Functor, class F>
void for_each_pack_of(Patches<Nodes> const& elements, Index patch, Functor const& functor,
                      F const& f) {
  constexpr int lanes = Pack<T>::lanes;
  auto members = elements.members(patch, Group);
  Index const first_of_patch = elements.patch_bounds()[static_cast<std::size_t>(patch)];
  std::uint16_t selected[Selects<Functor> ? PatchOrder::largest : 1];
  if constexpr (Selects<Functor>) {
    auto* const end = std::ranges::copy_if(members, selected, [&](std::uint16_t e) {
                        return functor.selects(first_of_patch + e, static_cast<Tag>(Group));
                      }).out;
    members = {selected, end};
  }
  for (std::size_t first = 0; first < members.size(); first += lanes) {
    PackMembers<T> m;
    m.patch = patch;
    m.first = first_of_patch;
    m.count = static_cast<int>(std::min<std::size_t>(lanes, members.size() - first));
    std::size_t const end = first + static_cast<std::size_t>(m.count);
    m.next = members.subspan(end, std::min<std::size_t>(lanes, members.size() - end));
    for (int l = 0; l < lanes; ++l)
      m.element[l] = m.first + members[first + static_cast<std::size_t>(std::min(l, m.count - 1))];
    f(GroupNumber<Group>{}, m);
  }
}
/// The same, group by group.
template <int Groups, class T, int Nodes, class Functor, class F>
void for_each_pack(Patches<Nodes> const& elements, Index patch, Functor const& functor,
                   F const& f) {
  [&]<int... G>(std::integer_sequence<int, G...>) {
    (for_each_pack_of<G, T>(elements, patch, functor, f), ...);
  }(std::make_integer_sequence<int, Groups>());
}

/// Asks for the rows of fields that the next pack works on, so that they are in the caches by then.
template <int Nodes, class T, class... Fields>
PLIANT_INLINE inline void prefetch_next(Patches<Nodes> const& elements, PackMembers<T> const& m,
                                        Fields const&... fields) {
  for (Index const e : m.next) {
    Index const* const nodes = elements.nodes(m.patch, m.first + e);
    for (int a = 0; a < Nodes; ++a)
      (__builtin_prefetch(fields.data + std::ptrdiff_t{node_stride} * nodes[a]), ...);
  }
}

/// The values of a field at the nodes of a pack's elements.
template <int Nodes, class T, class U, int C>
PLIANT_INLINE inline Matrix<Pack<T>, Nodes, C> gather_pack(Patches<Nodes> const& elements,
                                                           PackMembers<T> const& m,
                                                           NodeField<U, C> const& field) {
  constexpr int lanes = Pack<T>::lanes;
  Matrix<Pack<T>, Nodes, C> values;
  for (int a = 0; a < Nodes; ++a) {
    Index nodes[lanes];
    for (int l = 0; l < lanes; ++l) nodes[l] = elements.nodes(m.patch, m.element[l])[a];
    typename Pack<T>::Register r[4];
    gather_nodes<T, lanes>(field.data, nodes, r);
    for (int k = 0; k < C; ++k) values(a, k).v = r[k];
  }
  return values;
}

template <class T, int N>
Vector<T, N> lane_of(Vector<Pack<T>, N> const& values, int lane) {
  Vector<T, N> own;
  for (int k = 0; k < N; ++k) own[k] = values[k][lane];
  return own;
}

}  // namespace pliant::detail
