#pragma once

#include <cassert>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include <pliant/math/matrix.hpp>

namespace pliant {

/// Values per node that are padded inside a backend: node i starts at `data[4 i]`, whatever the
/// number of components, so that a node is one aligned vector.
inline constexpr int node_stride = 4;

namespace detail {

/// The first values of a padded row as a GPU moves them: all of them, and the padding behind three, by
/// as few accesses as its alignment allows.
template <class T, int Components>
struct alignas(sizeof(T) * Components > 8 ? 16 : sizeof(T) * Components) PaddedRow {
  static constexpr int width = Components == 3 ? 4 : Components;
  T values[width];
};

}  // namespace detail

/// A view of vectors per node in a backend's memory, `Components` of each read or written.
template <class T, int Components>
struct NodeField {
  static constexpr int components = Components;
  using value_type = std::remove_const_t<T>;
  T* data;  // (nodes, 4)
  /// As far as known; debug builds check that nodes are below.
  Index nodes = std::numeric_limits<Index>::max();

  PLIANT_HOST_DEVICE T& operator()(Index node, int k) const {
    assert(k >= 0 && k < Components);
    return row(node)[k];
  }
  PLIANT_HOST_DEVICE auto at(Index node) const {
    Vector<value_type, Components> v;
#if defined(__CUDA_ARCH__)
    auto const all = *reinterpret_cast<Row const*>(row(node));
    for (int k = 0; k < Components; ++k) v[k] = all.values[k];
#else
    for (int k = 0; k < Components; ++k) v[k] = (*this)(node, k);
#endif
    return v;
  }
  /// What is behind three values may become zero.
  PLIANT_HOST_DEVICE void set(Index node, Vector<value_type, Components> const& v) const {
#if defined(__CUDA_ARCH__)
    Row all{};
    for (int k = 0; k < Components; ++k) all.values[k] = v[k];
    *reinterpret_cast<Row*>(row(node)) = all;
#else
    for (int k = 0; k < Components; ++k) (*this)(node, k) = v[k];
#endif
  }

 private:
  using Row = detail::PaddedRow<value_type, Components>;
  PLIANT_HOST_DEVICE T* row(Index node) const {
    assert(node >= 0 && node < nodes);
    return data + static_cast<std::ptrdiff_t>(node_stride) * node;
  }
};

/// The view of an array of padded rows, which knows how many there are.
template <int Components, class A>
auto node_field(A& array) {
  using T = std::remove_pointer_t<decltype(array.data())>;
  return NodeField<T, Components>{array.data(), static_cast<Index>(array.size() / node_stride)};
}

/// A view of values per element in a backend's memory: value k of element e is `data[k elements + e]`.
template <class T, int Components>
struct ElementField {
  T* data;  // (components, elements)
  Index elements;

  PLIANT_HOST_DEVICE T& operator()(Index element, int k) const {
    assert(element >= 0 && element < elements && k >= 0 && k < Components);
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
