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
/// Whether an entry of a list is a place.
struct IsPlace {
  Index const* places;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return places[i] >= 0; }
};
/// Puts a place in place of its number in a list.
struct TakePlace {
  Index const* places;
  Index* taken;
  PLIANT_HOST_DEVICE void operator()(Index i) const { taken[i] = places[taken[i]]; }
};
/// Places that meet a condition; −1 in place of others.
template <class Condition>
struct PlacesThatMeet {
  Condition meets;
  PLIANT_HOST_DEVICE Index operator[](Index place) const { return meets(place) ? place : -1; }
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

/// The same of the elements of a table at some places, (count); −1 for none. Places, and the tags of the table, are in the backend's
/// memory. `nodes`: how many rows fields have.
template <int Groups, Backend B, class Elements, class Kernel, class... Fields>
void add_sum_elements_at(B const& backend, Elements const& table, Tag const* tags,
                         Index const* places, Index count, Index nodes, Kernel const& kernel,
                         double* to, Fields const&... fields) {
  if constexpr (sums_at_places<B>) {
    backend.template add_sum_elements_at<Groups>(table, places, count, kernel, to, fields...);
  } else {
    auto const which = backend.select(count, detail::IsPlace{places});
    if (which.empty()) return;
    auto const some = static_cast<Index>(which.size());
    auto own = upload(backend, which);
    backend.for_each(some, detail::TakePlace{places, own.data()});
    add_sum_elements<Groups>(backend,
                             element_list(backend, table, tags, own.data(), some, Groups, nodes),
                             kernel, to, fields...);
  }
}
/// The same of the elements of which the places meet a condition, meets(place).
template <int Groups, Backend B, class Elements, class Condition, class Kernel, class... Fields>
void add_sum_elements_if(B const& backend, Elements const& table, Tag const* tags,
                         Condition const& meets, Index nodes, Kernel const& kernel, double* to,
                         Fields const&... fields) {
  if constexpr (sums_at_places<B>) {
    backend.template add_sum_elements_at<Groups>(table, detail::PlacesThatMeet<Condition>{meets},
                                                 table.count(), kernel, to, fields...);
  } else {
    auto places = unset<Index>(backend, static_cast<std::size_t>(table.count()));
    auto listed = zeros<Index>(backend, 1);
    backend.select(table.count(), meets, places.data(), listed.data());
    if (Index const count = download<Index>(listed)[0]; count > 0)
      add_sum_elements_at<Groups>(backend, table, tags, places.data(), count, nodes, kernel, to,
                                  fields...);
  }
}

}  // namespace pliant
