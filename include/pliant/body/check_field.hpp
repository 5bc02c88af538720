#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant::detail {

/// Throws Error where a field that was handed in has not the body's size, or is not finite in the precision T.
template <class T = double, std::size_t Dim>
void check_field(char const* what, std::vector<std::array<double, Dim>> const& values,
                 Index nodes) {
  if (values.size() != static_cast<std::size_t>(nodes))
    throw Error(what, ": got values for ", values.size(), " nodes, but the body has ", nodes);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (double x : values[i])
      if (!std::isfinite(static_cast<T>(x)))
        throw Error(what, ": the value at node ", i,
                    std::isfinite(x) ? " is too large for single precision" : " is not finite");
}

}  // namespace pliant::detail
