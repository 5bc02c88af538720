#pragma once

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Calls f(GroupNumber<tag>{}); does nothing for a tag that is no group.
template <int Groups, int G = 0, class F>
PLIANT_HOST_DEVICE void dispatch(Tag tag, F const& f) {
  if constexpr (G < Groups) {
    if (tag == G)
      f(GroupNumber<G>{});
    else
      dispatch<Groups, G + 1>(tag, f);
  }
}

/// A kernel or visitor that asks where it is, for the sake of values per element.
template <class Kernel>
concept ReadsElements = requires { requires Kernel::reads_elements; };

/// kernel(group, v...), or kernel(group, own, v...) for one that asks.
template <class Kernel, class Group, class Own, class... V>
PLIANT_HOST_DEVICE auto call(Kernel const& kernel, Group group, Own const& own, V const&... v) {
  if constexpr (ReadsElements<Kernel>)
    return kernel(group, own, v...);
  else
    return kernel(group, v...);
}
/// The same with visitor.evaluate.
template <class Visitor, class Group, class Own, class... V>
PLIANT_HOST_DEVICE auto evaluate_at(Visitor const& visitor, Group group, Own const& own,
                                    V const&... v) {
  if constexpr (ReadsElements<Visitor>)
    return visitor.evaluate(group, own, v...);
  else
    return visitor.evaluate(group, v...);
}

}  // namespace pliant
