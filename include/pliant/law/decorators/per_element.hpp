#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// A law all of whose parameters differ between elements, such as a material that grades from soft
/// to hard: Formulation<Hex8, Gauss<2>, PerElement<NeoHookean>::law>. The values of an element are
/// the members of L, in their order.
template <template <class> class L>
struct PerElement {
  template <class T>
  struct law {
    static constexpr int element_values = static_cast<int>(parameter_count<L<T>, T>);
    static constexpr bool takes_inversion = pliant::takes_inversion<L<T>>;

    template <class S>
    PLIANT_HOST_DEVICE auto at(Vector<S, element_values> const& values) const {
      return [&]<int... I>(std::integer_sequence<int, I...>) PLIANT_INLINE {
        return L<S>{values[I]...};
      }(std::make_integer_sequence<int, element_values>());
    }
    static law from(Elastic const&) { return {}; }
  };
};

}  // namespace pliant
