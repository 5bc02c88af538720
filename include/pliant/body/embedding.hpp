#pragma once

#include <pliant/constraint/conditions.hpp>

// A body's forces for a simulator that owns its state. The functions are those of Body, where units and errors are
// documented.
namespace pliant {

namespace detail {
inline constexpr double unset_step = -1;

/// Throws Error where laws need a step size, s, that was not given.
template <class Parts>
double checked_step(char const* verb, double dt) {
  if (dt == unset_step && !Parts::has_internal_variables) return 0;
  if (dt == unset_step)
    throw Error("body.", verb,
                ": this body's laws have internal variables; give the time since they were "
                "committed, 0 s or more");
  if (!(dt >= 0)) throw Error("body.", verb, ": a step of ", dt, " s; give 0 or more");
  return dt;
}
inline void check_stride(char const* verb, int stride, int dim) {
  if (stride < dim)
    throw Error("body.", verb, ": stride ", stride, " is smaller than the dimension ", dim,
                "; node i starts at [stride i]");
}
template <class Parts>
typename Parts::Scratch& scratch_of(Parts& parts) {
  if (!parts.scratch) {
    auto const make = [&](std::size_t size) {
      return zeros<typename Parts::T>(parts.backend, size);
    };
    parts.scratch =
        typename Parts::Scratch{make(parts.layout.rest.size()), make(parts.layout.rest.size()),
                                make(parts.layout.f.size())};
  }
  return *parts.scratch;
}
/// A user's array as a padded field in internal order, slaves interpolated.
template <class Parts>
typename Parts::Field from_user(Parts& parts, typename Parts::T const* values, int stride,
                                typename Parts::template Array<typename Parts::T>& to) {
  typename Parts::Field const field{to.data()};
  parts.backend.for_each(parts.layout.rows, FromUser<typename Parts::T, Parts::dim>{
                                                field, values, stride,
                                                parts.layout.user_nodes_on(parts.backend).data()});
  parts.layout.interpolation.apply(parts.backend, field);
  return field;
}
/// Adds a padded field to a user's array; what slaves held is with their masters.
template <class Parts>
void add_to_user(Parts& parts, typename Parts::Field field, typename Parts::T* to, int stride) {
  parts.layout.interpolation.clear(parts.backend, field);
  parts.backend.for_each(
      parts.layout.rows,
      AddToUser<typename Parts::T, Parts::dim>{
          {field.data}, to, stride, parts.layout.user_nodes_on(parts.backend).data()});
}
}  // namespace detail

template <class Parts>
void add_force(Parts& parts, typename Parts::T const* u, typename Parts::T* f, int stride,
               double dt) {
  detail::check_stride("add_force", stride, Parts::dim);
  WithStepSize<Parts> const with(parts, detail::checked_step<Parts>("add_force", dt));
  auto& scratch = detail::scratch_of(parts);
  auto const own_u = detail::from_user(parts, u, stride, scratch.u);
  typename Parts::Field const own_f{scratch.f.data()};
  clear_rows(parts, own_f);
  accumulate_forces(parts, {own_u.data}, own_f);
  detail::add_to_user(parts, own_f, f, stride);
}

template <class Parts>
void add_tangent_product(Parts& parts, typename Parts::T const* u, typename Parts::T const* du,
                         typename Parts::T* f, double factor, int stride, double dt) {
  using T = typename Parts::T;
  detail::check_stride("add_tangent_product", stride, Parts::dim);
  WithStepSize<Parts> const with(parts, detail::checked_step<Parts>("add_tangent_product", dt));
  auto& scratch = detail::scratch_of(parts);
  auto const own_u = detail::from_user(parts, u, stride, scratch.u);
  auto const own_du = detail::from_user(parts, du, stride, scratch.du);
  typename Parts::Field const own_f{scratch.f.data()};
  clear_rows(parts, own_f);
  for_each_force_term(parts, [&](auto const& term) {
    term.add_tangent_product(parts.backend, static_cast<T>(factor), parts.at({own_u.data}),
                             {own_du.data}, own_f);
  });
  parts.layout.interpolation.add_transpose(parts.backend, own_f);
  detail::add_to_user(parts, own_f, f, stride);
}

template <class Parts>
double energy_of(Parts& parts, typename Parts::T const* u, int stride) {
  detail::check_stride("energy", stride, Parts::dim);
  auto const own_u = detail::from_user(parts, u, stride, detail::scratch_of(parts).u);
  return energy_at(parts, {own_u.data});
}

template <class Parts>
void add_lumped_mass(Parts const& parts, typename Parts::T* m) {
  parts.backend.for_each(parts.layout.rows, AddMass<typename Parts::T>{
                                                parts.layout.mass.data(), m,
                                                parts.layout.user_nodes_on(parts.backend).data()});
}

template <class Parts>
void commit(Parts& parts, typename Parts::T const* u, double dt, int stride) {
  detail::check_stride("commit", stride, Parts::dim);
  [[maybe_unused]] double const step = detail::checked_step<Parts>("commit", dt);
  if constexpr (Parts::has_internal_variables) {
    auto const own_u = detail::from_user(parts, u, stride, detail::scratch_of(parts).u);
    change_by_hand(parts, [&] {
      WithStepSize<Parts> const with(parts, step);
      commit_at(parts, {own_u.data});
    });
  }
}

}  // namespace pliant
