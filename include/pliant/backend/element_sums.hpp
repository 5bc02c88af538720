#pragma once

#include <pliant/backend/backend.hpp>
#include <pliant/backend/elements_of_rows.hpp>

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

/// Whether a backend sums over elements where they are in a table, so that kernels may read what is kept by their numbers.
template <class B>
inline constexpr bool sums_at_places = requires { requires B::sums_at_places; };

/// The same of the elements of a table at some places, (count). Places, and the tags of the table, are in the backend's memory.
/// `nodes`: how many rows fields have.
template <int Groups, Backend B, class Elements, class Kernel, class... Fields>
void add_sum_elements_at(B const& backend, Elements const& table, Tag const* tags,
                         Index const* places, Index count, Index nodes, Kernel const& kernel,
                         double* to, Fields const&... fields) {
  if constexpr (sums_at_places<B>)
    backend.template add_sum_elements_at<Groups>(table, places, count, kernel, to, fields...);
  else
    add_sum_elements<Groups>(backend,
                             element_list(backend, table, tags, places, count, Groups, nodes),
                             kernel, to, fields...);
}

}  // namespace pliant
