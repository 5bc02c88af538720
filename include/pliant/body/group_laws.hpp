#pragma once

#include <algorithm>
#include <tuple>

#include <pliant/backend/field.hpp>
#include <pliant/formulation/physics.hpp>

namespace pliant {

/// How many numbers a formulation keeps per element: those its law reads, and those that its
/// quadrature points keep from step to step.
template <class F>
inline constexpr int element_values = 0;
template <class F>
  requires LawPerElement<typename F::template law<double>>
inline constexpr int element_values<F> = F::template law<double>::element_values;
template <class F>
inline constexpr int internal_variables_of = 0;
template <class F>
  requires LawWithInternalVariables<typename F::template law<double>>
inline constexpr int internal_variables_of<F> =
    F::points * F::template law<double>::template internal_variables<F::dim>;

/// Whether elements that go from one group to the other keep what their points keep.
template <class From, class To>
inline constexpr bool keeps_internal_variables =
    internal_variables_of<To> == 0 ||
    (internal_variables_of<From> == internal_variables_of<To> &&
     std::same_as<typename From::quadrature, typename To::quadrature>);

/// What elements of one type keep in the backend's memory.
template <class T>
struct ElementData {
  T const* values = nullptr;        // (values, elements)
  T* internal_variables = nullptr;  // (internal variables, elements)
  Index elements = 0;
};

/// A law with the internal variables of an element: `at_point(q)` is the law at quadrature point q.
template <int Size, class L, class T, class Own>
struct LawOfElement {
  L const& law;
  ElementField<T const, 0> internal_variables;
  Own const& own;

  PLIANT_HOST_DEVICE auto at_point(int q) const {
    return law.after(own(internal_variables.template part<Size>(Size * q)));
  }
};

/// The formulations of one element type and their laws in the precision of the kernels.
template <class T, class... Fs>
struct GroupLaws {
  template <int G>
  using formulation = std::tuple_element_t<G, std::tuple<Fs...>>;
  static constexpr int value_count = (0 + ... + element_values<Fs>);
  /// Where the values of group G begin; what points keep is shared by all groups.
  template <int G>
  static constexpr int first_value() {
    constexpr int counts[] = {element_values<Fs>...};
    int first = 0;
    for (int g = 0; g < G; ++g) first += counts[g];
    return first;
  }
  static constexpr int internal_variable_count = std::max({0, internal_variables_of<Fs>...});
  static constexpr bool reads_elements = value_count > 0 || internal_variable_count > 0;
  /// Whether forces are those of a SymmetricKernel: what points keep is theirs, wherever they lie.
  static constexpr bool symmetric = ((LinearSimplex<typename Fs::element> &&
                                      (internal_variables_of<Fs> == 0 || Fs::points == 1)) &&
                                     ...);
  /// Whether forces take few operations per element.
  static constexpr bool few_operations = (has_two_invariants<typename Fs::template law<T>> && ...);

  std::tuple<decltype(prepared<Fs>(std::declval<typename Fs::template law<T>>(), 0.0))...> laws;
  ElementData<T> data{};

  /// Calls f with the law of group G and v...; `own` comes before them if `reads_elements`.
  template <int G, class F, class First, class... V>
  PLIANT_HOST_DEVICE auto apply(F const& f, First const& first, V const&... v) const {
    if constexpr (reads_elements)
      return f(law<G>(first), v...);
    else
      return f(law<G>(), first, v...);
  }
  template <int G>
  PLIANT_HOST_DEVICE auto const& law() const {
    return std::get<G>(laws);
  }
  /// The law of group G at an element.
  template <int G, class Own>
  PLIANT_HOST_DEVICE auto law(Own const& own) const {
    using F = formulation<G>;
    if constexpr (internal_variables_of<F> > 0) {
      using L = std::remove_cvref_t<decltype(std::get<G>(laws))>;
      return LawOfElement<internal_variables_of<F> / F::points, L, T, Own>{
          std::get<G>(laws), {data.internal_variables, data.elements}, own};
    } else if constexpr (element_values<F> > 0) {
      ElementField<T const, 0> const all{data.values, data.elements};
      return std::get<G>(laws).at(own(all.template part<element_values<F>>(first_value<G>())));
    } else {
      return std::get<G>(laws);
    }
  }
};

}  // namespace pliant
