#pragma once

#include <pliant/solver/least_jacobian.hpp>

namespace pliant {

namespace detail {

/// det F of each element where it is least of its lattice points, by which the gradients are given.
template <class T, class Laws>
struct LeastJacobianVisitor {
  static constexpr int counters = 0;
  T* values;           // (elements)
  T const* gradients;  // (points, nodes, dim)
  int points;
  unsigned char const* linear;  // (groups): whether to pass over

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const& u) const {
    using E = typename Laws::template formulation<G>::element;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    V now;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) now(a, k) = rest(a, k) + u(a, k);
    Vector<S, 1> least;
    least[0] = S(std::numeric_limits<T>::max());
    T const* gradient = gradients;
    for (int q = 0; q < points; ++q, gradient += E::nodes * E::dim) {
      auto before = Tensor<S, E::dim>::zero(), after = before;
      for (int a = 0; a < E::nodes; ++a)
        for (int i = 0; i < E::dim; ++i)
          for (int j = 0; j < E::dim; ++j) {
            T const g = gradient[E::dim * a + j];
            before(i, j) = before(i, j) + g * rest(a, i);
            after(i, j) = after(i, j) + g * now(a, i);
          }
      S const j = determinant(after) / determinant(before);
      least[0] = select(j < least[0], j, least[0] + S(0) * j);  // not a number once j is none
    }
    return least;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    constexpr T most = std::numeric_limits<T>::max();
    // What is not a number counts as folded.
    values[e] = linear[G] != 0 ? most : value[0] >= -most ? value[0] : -most;
  }
};

template <class T>
struct NegativeAt {
  T const* values;
  PLIANT_HOST_DEVICE double operator()(Index i) const { return -static_cast<double>(values[i]); }
};

/// Largest at the first of the values that are not above one: minus its number.
template <class T>
struct FirstOf {
  T const* values;
  double value;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return static_cast<double>(values[i]) <= value ? -static_cast<double>(i)
                                                   : -std::numeric_limits<double>::infinity();
  }
};

/// Gradients of an element's shape functions on its lattice as one list.
template <Element E, class T>
std::vector<T> listed_gradients() {
  std::vector<T> list;
  for (auto const& gradient : gradients_on_lattice<E>())
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) list.push_back(static_cast<T>(gradient(a, k)));
  return list;
}

}  // namespace detail

/// Where an element is compressed most at displacements in the backend's memory: of all elements, or of those whose
/// law is not linear.
template <class Parts>
LeastJacobian least_jacobian_on(Parts& parts, typename Parts::ConstField u, bool all) {
  using T = typename Parts::T;
  LeastJacobian found;
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    if (table.count() == 0) return;
    std::vector<unsigned char> linear(Table::groups, 0);
    [&]<int... G>(std::integer_sequence<int, G...>) {
      ((linear[G] = !all && detail::is_linear<Parts::dim>(
                                parts.template law_of<typename Table::template formulation<G>>())),
       ...);
    }(std::make_integer_sequence<int, Table::groups>());
    if (std::ranges::count(linear, 0) == 0) return;
    if (table.scratch.size() == 0)
      table.scratch = zeros<T>(parts.backend, static_cast<std::size_t>(table.count()));
    auto const gradients = upload(parts.backend, detail::listed_gradients<E, T>());
    auto const passed = upload(parts.backend, linear);
    parts.backend.template visit<Table::groups>(
        table.elements,
        detail::LeastJacobianVisitor<T, typename Table::Laws>{
            table.scratch.data(), gradients.data(),
            static_cast<int>(gradients.size()) / (E::nodes * E::dim), passed.data()},
        parts.no_counters, parts.rest(), u);
    double const least =
        -parts.backend.maximum(table.count(), detail::NegativeAt<T>{table.scratch.data()});
    if (!(least < found.value)) return;
    double const at =
        -parts.backend.maximum(table.count(), detail::FirstOf<T>{table.scratch.data(), least});
    found = {least, E::name(), table.user_element(static_cast<Index>(at))};
  });
  return found;
}

}  // namespace pliant
