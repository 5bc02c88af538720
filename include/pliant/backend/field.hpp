#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

#include <pliant/math/matrix.hpp>

namespace pliant {

/// Values per node that are padded inside a backend: node i starts at `data[4 i]`, whatever the
/// number of components, so that a node is one aligned vector.
inline constexpr int node_stride = 4;

/// A view of vectors per node in a backend's memory, `Components` of each read or written.
template <class T, int Components>
struct NodeField {
  static constexpr int components = Components;
  T* data;  // (nodes, 4)

  PLIANT_HOST_DEVICE T& operator()(Index node, int k) const {
    return data[static_cast<std::ptrdiff_t>(node_stride) * node + k];
  }
  PLIANT_HOST_DEVICE auto at(Index node) const {
    Vector<std::remove_const_t<T>, Components> v;
    for (int k = 0; k < Components; ++k) v[k] = (*this)(node, k);
    return v;
  }
  PLIANT_HOST_DEVICE void set(Index node,
                              Vector<std::remove_const_t<T>, Components> const& v) const {
    for (int k = 0; k < Components; ++k) (*this)(node, k) = v[k];
  }
};

/// A view of values per element in a backend's memory: value k of element e is `data[k elements + e]`.
template <class T, int Components>
struct ElementField {
  T* data;  // (components, elements)
  Index elements;

  PLIANT_HOST_DEVICE T& operator()(Index element, int k) const {
    return data[static_cast<std::ptrdiff_t>(elements) * k + element];
  }
  /// `Count` of the values, from value `first` on.
  template <int Count>
  PLIANT_HOST_DEVICE ElementField<T, Count> part(int first) const {
    return {data + static_cast<std::ptrdiff_t>(elements) * first, elements};
  }
};

/// Gives the values of an ElementField at one element, when called.
struct OneElement {
  Index element;

  template <class T, int C>
  PLIANT_HOST_DEVICE auto operator()(ElementField<T, C> const& field) const {
    Vector<std::remove_const_t<T>, C> values;
    for (int k = 0; k < C; ++k) values[k] = field(element, k);
    return values;
  }
};

/// The values of a field at the nodes of one element: (nodes, components).
template <int Nodes, class T, int Components>
PLIANT_HOST_DEVICE auto gather(NodeField<T, Components> const& field, Index const* nodes) {
  Matrix<std::remove_const_t<T>, Nodes, Components> values;
  for (int a = 0; a < Nodes; ++a)
    for (int k = 0; k < Components; ++k) values(a, k) = field(nodes[a], k);
  return values;
}

/// Gathers several fields at the nodes of one element, when called: the `again` of `visit`.
template <int Nodes, class... Fields>
struct Gather {
  Index const* nodes;
  std::tuple<Fields...> fields;

  PLIANT_HOST_DEVICE auto operator()() const { return at(std::index_sequence_for<Fields...>()); }

 private:
  template <std::size_t... I>
  PLIANT_HOST_DEVICE auto at(std::index_sequence<I...>) const {
    return std::tuple{gather<Nodes>(std::get<I>(fields), nodes)...};
  }
};

}  // namespace pliant
