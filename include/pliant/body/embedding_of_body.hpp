#pragma once

#include <pliant/body/body.hpp>

// Members of Body for a simulator that owns its state.
namespace pliant {

namespace detail {
inline void check_stride(char const* verb, int stride, int dim) {
  if (stride < dim)
    throw Error("body.", verb, ": stride ", stride, " is smaller than the dimension ", dim,
                "; node i starts at [stride i]");
}
}  // namespace detail

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::scratch() -> Scratch& {
  if (!scratch_) {
    using A = typename B::template Array<T>;
    scratch_ = Scratch{A(layout_.u.size()), A(layout_.u.size()), A(layout_.f.size())};
  }
  return *scratch_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_force(T const* u, T* f, int stride) {
  detail::check_stride("add_force", stride, dim);
  Scratch& s = scratch();
  Field const own_u{s.u.data()}, own_f{s.f.data()};
  Index const* order = layout_.user_node_array.data();
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, order});
  layout_.slaves.interpolate(backend_, own_u);
  clear(own_f, nodes());
  accumulate_forces({own_u.data}, own_f);
  layout_.slaves.clear(backend_, own_f);
  backend_.for_each(nodes(), AddToUser<T, dim>{{own_f.data}, f, stride, order});
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_tangent_product(T const* u, T const* du, T* f, double factor,
                                            int stride) {
  detail::check_stride("add_tangent_product", stride, dim);
  Scratch& s = scratch();
  Field const own_u{s.u.data()}, own_du{s.du.data()}, own_f{s.f.data()};
  Index const* order = layout_.user_node_array.data();
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, order});
  backend_.for_each(nodes(), FromUser<T, dim>{own_du, du, stride, order});
  layout_.slaves.interpolate(backend_, own_u);
  layout_.slaves.interpolate(backend_, own_du);
  clear(own_f, nodes());
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    table.with_geometry([&](auto geometry) {
      backend_.template accumulate<Table::groups>(
          table.elements,
          TangentKernel<T, typename Table::Laws, geometry.value>{table.laws,
                                                                 static_cast<T>(factor)},
          own_f, rest_field(), ConstField{own_u.data}, ConstField{own_du.data});
    });
  });
  surface_forces_.add_tangent_product(backend_, static_cast<T>(factor), rest_field(),
                                      ConstField{own_u.data}, ConstField{own_du.data}, own_f);
  layout_.slaves.hand_to_masters(backend_, own_f);
  layout_.slaves.clear(backend_, own_f);
  backend_.for_each(nodes(), AddToUser<T, dim>{{own_f.data}, f, stride, order});
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::energy(T const* u, int stride) {
  detail::check_stride("energy", stride, dim);
  Scratch& s = scratch();
  Field const own_u{s.u.data()};
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, layout_.user_node_array.data()});
  layout_.slaves.interpolate(backend_, own_u);
  return energy_at(s.u);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_lumped_mass(T* m) const {
  backend_.for_each(nodes(), AddMass<T>{layout_.mass.data(), m, layout_.user_node_array.data()});
}

}  // namespace pliant
