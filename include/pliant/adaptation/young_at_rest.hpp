#pragma once

#include <array>

#include <pliant/adaptation/criterion/criterion.hpp>

namespace pliant::detail {

/// A criterion that asks for Young's modulus, by itself or in what it is made of.
template <class C>
inline constexpr bool some_reads_young = false;
template <class C>
concept ReadsYoung =
    requires { requires C::reads_young; } || some_reads_young<std::remove_cvref_t<C>>;
template <class... Cs>
inline constexpr bool some_of_reads_young = (ReadsYoung<Cs> || ...);
template <class Tuple>
inline constexpr bool tuple_reads_young = false;
template <class... Cs>
inline constexpr bool tuple_reads_young<std::tuple<Cs...>> = (ReadsYoung<Cs> || ...);
template <class C>
  requires requires(C const& c) { std::tuple_size<decltype(c.criteria)>::value; }
inline constexpr bool some_reads_young<C> = tuple_reads_young<decltype(C::criteria)>;

/// Young's modulus of a law at rest, Pa, as a bar along the first axis has it; of a sheet, as it has in plane
/// stress. Of a law that reads values of elements with these.
template <class L, std::size_t N = 0>
double young_at_rest(L const& law, std::array<double, N> const& values = {}) {
  if constexpr (LawWithInternalVariables<L>) {
    auto const now = law.over(std::numeric_limits<double>::infinity());
    return young_at_rest(now.after(now.equilibrated(Tensor<double, 3>::zero())), values);
  } else if constexpr (LawPerElement<L>) {
    Vector<double, L::element_values> row;
    for (std::size_t k = 0; k < N; ++k) row[static_cast<int>(k)] = values[k];
    return young_at_rest(law.at(row), values);
  } else {
    constexpr int dim = SolidLaw<L> ? 3 : 2;
    auto const rest = Tensor<double, dim>::zero();
    auto along = rest, across = rest;
    along(0, 0) = 1;
    for (int k = 1; k < dim; ++k) across(k, k) = 1;
    // Stretched by one and thinned by as much as frees the sides.
    auto const p = stress_tangent_product(law, rest, along),
               side = stress_tangent_product(law, rest, across);
    return p(0, 0) - side(0, 0) * (p(1, 1) / side(1, 1));
  }
}

}  // namespace pliant::detail
