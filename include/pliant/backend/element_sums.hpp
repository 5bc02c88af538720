#pragma once

#include <pliant/backend/backend.hpp>

// Sums over elements that stay in a backend's memory.
namespace pliant {

namespace detail {
/// *to += value.
struct AddValue {
  double* to;
  double value;
  PLIANT_HOST_DEVICE void operator()(Index) const { *to += value; }
};
}  // namespace detail

/// Adds what sum_elements gives to *to in the backend's memory.
template <int Groups, Backend B, class Table, class Kernel, class... Fields>
void add_sum_elements(B const& backend, Table const& table, Kernel const& kernel, double* to,
                      Fields const&... fields) {
  if constexpr (requires {
                  backend.template add_sum_elements<Groups>(table, kernel, to, fields...);
                })
    backend.template add_sum_elements<Groups>(table, kernel, to, fields...);
  else
    backend.for_each(
        1, detail::AddValue{to, backend.template sum_elements<Groups>(table, kernel, fields...)});
}

}  // namespace pliant
