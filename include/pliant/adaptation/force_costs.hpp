#pragma once

#include <algorithm>
#include <array>

#include <pliant/body/parts.hpp>
#include <pliant/force/element_kernels.hpp>
#include <pliant/math/counted.hpp>

// What the force of one element costs in each of several groups.
namespace pliant {

namespace detail {

/// A law for one element that reads `values`, its points at rest.
template <class L, std::size_t N>
auto law_of_one_element(L const& law, std::array<double, N> const& values) {
  if constexpr (LawWithInternalVariables<L>) {
    auto const now = law.over(0);
    return now.after(now.equilibrated(Tensor<double, 3>::zero()));
  } else if constexpr (LawPerElement<L>) {
    Vector<double, L::element_values> row;
    for (std::size_t k = 0; k < N; ++k) row[static_cast<int>(k)] = values[k];
    return law_of_one_element(law.at(row), values);
  } else {
    return law;
  }
}

/// How many operations the force of an element takes, those on memory included; whether or not the mesh has one.
template <class F, class Parts>
double count_force(Parts const& parts) {
  using E = typename F::element;
  Nodal<E, Counted> rest, u;
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) {
      rest(a, k) = Counted(E::place(a)[k]);
      u(a, k) = Counted(0);
    }
  auto const law =
      prepared<F>(law_of_one_element(parts.template law_of<F>(), first_values<F>(parts)));
  auto const before = Counted::count();
  (void)force<F>(law, rest, u);
  constexpr int moved = 4 * E::nodes * E::dim;  // positions, displacements, forces in and out
  return static_cast<double>(Counted::count() - before + moved);
}

template <std::size_t N>
std::array<double, N> relative_to_last(std::array<double, N> costs) {
  for (std::size_t k = 0; k < N; ++k) costs[k] /= costs[N - 1];
  return costs;
}

/// By counted operations, the same on all machines.
template <class Parts, class... Fs>
std::array<double, sizeof...(Fs)> counted_costs(Parts const& parts, TypeList<Fs...>) {
  return relative_to_last(std::array{count_force<Fs>(parts)...});
}

}  // namespace detail

/// What the force of one element costs in each of several groups of a body, in that of the last one, measured here and
/// now on copies of its tables; for WithinOptions::costs. The least of several runs. The body stays as it is.
template <class... Fs, DeformableBody TheBody>
std::array<double, sizeof...(Fs)> measure_costs(TheBody const& body) {
  using T = typename TheBody::scalar;
  using E = typename std::tuple_element_t<0, std::tuple<Fs...>>::element;
  static_assert((std::same_as<typename Fs::element, E> && ...),
                "measure_costs: the groups are of one element");
  static_assert(TheBody::layout_type::template has<E>,
                "measure_costs: the body's mesh does not have this element type");
  auto const& parts = body.parts();
  auto const& backend = parts.backend;
  auto const& table = parts.layout.template table<E>();
  using Table = std::remove_cvref_t<decltype(table)>;
  static_assert(((Table::template group_of<Fs> < Table::groups) && ...),
                "measure_costs: the body has no Group of one of these formulations");
  auto connectivity = body.mesh().template elements<E>();
  if (connectivity.empty()) throw Error("measure_costs: the mesh has no ", E::name(), " element");
  auto const& user = table.user_elements();
  for (std::size_t e = 0; e < connectivity.size(); ++e) {
    connectivity[e] = body.mesh().template elements<E>()[static_cast<std::size_t>(user[e])];
    for (Index& node : connectivity[e]) node = parts.layout.internal_of(node);
  }
  auto f = zeros<T>(backend, parts.layout.f.size());
  auto const measure = [&](int group) {
    typename TheBody::backend_type::template Elements<E::nodes> const elements(
        backend, connectivity, Table::groups,
        std::vector<Tag>(connectivity.size(), static_cast<Tag>(group)), parts.layout.rows,
        node_order<E>);
    double least = std::numeric_limits<double>::infinity(), sum = 0;
    for (int run = 0; run < 5 || (sum < 0.02 && run < 1000); ++run) {
      auto timer = backend.timer();
      timer.start();
      table.with_geometry([&](auto geometry) {
        backend.template accumulate<Table::groups>(
            elements, ForceKernel<typename Table::Laws, geometry.value>{table.laws},
            node_field<TheBody::dim>(f), parts.rest(), parts.u());
      });
      timer.stop();
      double const seconds = timer.seconds();
      sum += seconds;
      if (seconds > 0) least = std::min(least, seconds);
    }
    return least;
  };
  return detail::relative_to_last(std::array{measure(Table::template group_of<Fs>)...});
}

}  // namespace pliant
