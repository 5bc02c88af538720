#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pliant/formulation/affine.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/check_hanging.hpp>
#include <pliant/mesh/check_middles.hpp>
#include <pliant/mesh/describe.hpp>
#include <pliant/quadrature/corners.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant {

namespace detail {

template <class M>
void check_finite(M const& mesh) {
  for_each_on_host(static_cast<Index>(mesh.nodes.size()), 16384, [&](Index node) {
    auto const& place = mesh.nodes[static_cast<std::size_t>(node)];
    for (double x : place)
      if (!std::isfinite(x))
        throw Error("mesh: node ", node, " at ", place, " is not finite; correct its coordinates");
  });
}

template <Element E, class M>
void check_element(M const& mesh, std::size_t e) {
  auto const& element = mesh.template elements<E>()[e];
  auto const count = static_cast<Index>(mesh.nodes.size());
  Nodal<E, double> rest;
  double size = 0;
  for (int a = 0; a < E::nodes; ++a) {
    Index const node = element[static_cast<std::size_t>(a)];
    if (node < 0 || node >= count)
      throw Error("mesh: ", describe<E>(mesh, e), " refers to node ", node,
                  ", but the mesh has nodes 0 to ", count - 1, "; correct the connectivity");
    for (int k = 0; k < E::dim; ++k) {
      rest(a, k) = mesh.nodes[static_cast<std::size_t>(node)][static_cast<std::size_t>(k)];
      size = std::max(size, std::abs(rest(a, k) - rest(0, k)));
    }
  }
  // Corners and quadrature points: where a map first folds, and where the forces look.
  double const smallest = 1e-12 * size * size * (E::dim == 3 ? size : 1);
  auto const check_volume = [&](double det) {
    if (!(det > smallest))
      throw Error("mesh: ", describe<E>(mesh, e), " is ",
                  det < -smallest ? "inverted" : "degenerate", " (Jacobian determinant ", det,
                  " near ", mesh.nodes[static_cast<std::size_t>(element[0])],
                  "); number its nodes counter-clockwise, or repair the mesh there");
  };
  if (auto const gradient = affine_gradient<E>(rest)) {
    check_volume(determinant(*gradient));
    return;
  }
  auto const coefficients = Coefficients<E, double>::of(rest);
  auto const check = [&]<class Q>(Q) {
    constexpr auto table = tabulate<E, Q, double>();
    for (int q = 0; q < table.count; ++q)
      check_volume(RestMap<E, double>::at(coefficients, table, q).volume);
  };
  check(Gauss<E::degree + 1>{});
  if constexpr (QuadratureOn<Corners, typename E::cell>) check(Corners{});
}

template <Element E, class M>
void check_elements(M const& mesh) {
  for_each_on_host(static_cast<Index>(mesh.template elements<E>().size()), few_elements(E::nodes),
                   [&](Index e) { check_element<E>(mesh, static_cast<std::size_t>(e)); });
}

/// Throws Error for a node of no element.
template <Element... Es>
void check_used(Mesh<Es...> const& mesh) {
  std::vector<std::uint8_t> used(mesh.nodes.size());
  auto const use = [&]<Element E>(E) {
    auto const& elements = mesh.template elements<E>();
    for_each_on_host(static_cast<Index>(elements.size()), few_elements(E::nodes), [&](Index e) {
      for (Index node : elements[static_cast<std::size_t>(e)])
        std::atomic_ref(used[static_cast<std::size_t>(node)]).store(1, std::memory_order_relaxed);
    });
  };
  (use(Es{}), ...);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] == 0)
      throw Error("mesh: node ", i, " at ", mesh.nodes[i],
                  " belongs to no element; leave it out, and number the others without it");
}

/// Throws Error where two elements of a type have the same nodes.
template <Element E, class M>
void check_twins(M const& mesh) {
  auto const& elements = mesh.template elements<E>();
  std::vector<Index> smallest(elements.size());
  for_each_on_host(static_cast<Index>(elements.size()), few_elements(E::nodes), [&](Index i) {
    auto const& element = elements[static_cast<std::size_t>(i)];
    smallest[static_cast<std::size_t>(i)] = *std::min_element(element.begin(), element.end());
  });
  auto const at_node = group_by_key(smallest, static_cast<Index>(mesh.nodes.size()));
  auto const sum = [&](Index e) {
    std::int64_t s = 0;
    for (Index node : elements[static_cast<std::size_t>(e)]) s += node;
    return s;
  };
  auto const sorted = [&](Index e) {
    auto nodes = elements[static_cast<std::size_t>(e)];
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  HostParts{static_cast<Index>(mesh.nodes.size()), 4096}([&](Index begin, Index end, int) {
    std::vector<std::int64_t> sums;
    for (Index node = begin; node < end; ++node) {
      auto const at = static_cast<std::size_t>(node);
      auto const first = at_node.order.begin() + at_node.first[at];
      auto const last = at_node.order.begin() + at_node.first[at + 1];
      sums.clear();
      for (auto i = first; i != last; ++i) {
        sums.push_back(sum(*i));
        for (auto j = first; j != i; ++j)
          if (sums[static_cast<std::size_t>(j - first)] == sums.back() && sorted(*i) == sorted(*j))
            throw Error("mesh: ", describe<E>(mesh, static_cast<std::size_t>(*i)), " is element ",
                        *j, " again; leave one of them out");
      }
    }
  });
}

/// Throws Error where slaves name nodes that there are not, with weights that are not positive or do not add up to
/// one, or that put the slave elsewhere: a rotation would strain the elements there.
template <class M>
void check_slaves(M const& mesh) {
  auto const count = static_cast<Index>(mesh.nodes.size());
  for (auto const& [node, masters] : mesh.slaves) {
    double sum = 0;
    bool good = node >= 0 && node < count && !masters.empty();
    for (auto const& [master, weight] : masters) {
      good = good && master >= 0 && master < count && master != node && weight > 0;
      sum += weight;
    }
    if (!good || !(std::abs(sum - 1) < 1e-9))
      throw Error("mesh: slave ", node,
                  " needs masters among the mesh's nodes, with positive weights that add up to 1");
    auto const& place = mesh.nodes[static_cast<std::size_t>(node)];
    Point<M::dim> off{};
    double reach = 0;
    for (auto const& [master, weight] : masters)
      for (std::size_t k = 0; k < M::dim; ++k) {
        double const apart = mesh.nodes[static_cast<std::size_t>(master)][k] - place[k];
        off[k] += weight * apart;
        reach = std::max(reach, std::abs(apart));
      }
    for (double x : off)
      if (!(std::abs(x) <= 1e-5 * reach))
        throw Error("mesh: slave ", node, " at ", place, " is ", off,
                    " away from where its masters and weights put it; correct one of them");
  }
}

}  // namespace detail

/// Throws Error when the mesh has no elements, a node that is not finite or belongs to no element, an index out
/// of range, an element that is inverted, has no volume or is there twice, or a node that hangs on an
/// edge or a flat side, or lies in the middle of one for one of its elements and not for another, and is not
/// listed as a slave; and for slaves whose weights do not add up to one or put them elsewhere. The message
/// names the first culprit.
template <Element... Es>
void check(Mesh<Es...> const& mesh) {
  HostThreads const threads(mesh);
  if ((mesh.template elements<Es>().empty() && ...))
    throw Error("mesh: there are no elements; fill mesh.elements<E>() before making a body");
  detail::check_finite(mesh);
  (detail::check_elements<Es>(mesh), ...);
  detail::check_used(mesh);
  (detail::check_twins<Es>(mesh), ...);
  detail::check_slaves(mesh);
  detail::check_middles(mesh);
  detail::check_hanging(mesh);
}

}  // namespace pliant
