#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <pliant/body/group_laws.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant {

namespace detail {
/// Throws Error, and says where() that is, when a law finds its parameters impossible.
template <class L, class Where>
void check_law(L const& law, Where const& where) {
  if constexpr (requires { law.check(); }) {
    try {
      law.check();
    } catch (Error const& error) {
      throw Error("body: the law ", where(), " is impossible: ", error.what());
    }
  }
}
}  // namespace detail

/// Values of elements by the mean of an element's nodes at rest, m; nothing where a law reads none.
template <class F>
struct ValuesByPlace {
  using type = std::function<std::array<double, element_values<F>>(Point<F::dim> const&)>;
};
template <class F>
  requires(element_values<F> == 0)
struct ValuesByPlace<F> {
  struct type {};
};

/// The elements that share a formulation at this moment. All elements of a type start in the first
/// group given for that type.
template <class F>
struct Group {
  using formulation = F;
  /// The parameters of the law; when not given they follow from the body's `Elastic`.
  std::optional<typename F::template law<double>> law{};
  /// Where the law has values per element (LawPerElement): those of each element of this type, in the
  /// user's order, or one row for all.
  std::vector<std::array<double, element_values<F>>> values{};
  /// In place of `values`: those of an element, by the mean of its nodes at rest, m. Elements that a change of the mesh
  /// makes are asked for too, where otherwise they have those of the element that they come from.
  typename ValuesByPlace<F>::type values_at{};

  /// The law, in double. Throws Error for impossible parameters, and where there are none and the law takes none
  /// from an Elastic.
  typename F::template law<double> law_for(Elastic const& material) const {
    using L = typename F::template law<double>;
    if (law) {
      int k = 0;
      for (double parameter : parameters(*law)) {
        if (!std::isfinite(parameter))
          throw Error("body: parameter ", k, " of the law given to the group on ",
                      F::element::name(), " is not finite; give finite parameters");
        ++k;
      }
      detail::check_law(*law, [] {
        return detail::message({"given to the group on ", F::element::name()});
      });
      return *law;
    }
    if constexpr (LawFromElastic<L>)
      return L::from(material);
    else
      throw Error(
          "body: a law that has no from(Elastic) needs its parameters: write Group<F>{law}");
  }
};

namespace detail {

template <class... Ts>
struct TypeList {
  static constexpr int size = sizeof...(Ts);
};

template <class List, class T>
struct Append;
template <class... Ts, class T>
struct Append<TypeList<Ts...>, T> {
  using type = TypeList<Ts..., T>;
};

/// The formulations of an element type, in their order.
template <class E, class Found, class... Fs>
struct FormulationsOf {
  using type = Found;
};
template <class E, class Found, class F, class... Fs>
struct FormulationsOf<E, Found, F, Fs...> {
  using next = std::conditional_t<std::same_as<typename F::element, E>,
                                  typename Append<Found, F>::type, Found>;
  using type = typename FormulationsOf<E, next, Fs...>::type;
};

/// The position of T in a list; the list's size when it is not there.
template <class T, class... Ts>
constexpr int position_in(TypeList<Ts...>) {
  int k = 0;
  (void)((std::same_as<T, Ts> ? false : (++k, true)) && ...);
  return k;
}

}  // namespace detail
}  // namespace pliant
