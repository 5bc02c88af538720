#pragma once

#include <pliant/body/parts.hpp>
#include <pliant/formulation/mass.hpp>

namespace pliant {

/// How inertia is spread: over the nodes that share an element, ∫ ρ N_a N_b dV, or to each node alone,
/// as explicit integration needs it (Body::add_lumped_mass).
enum class MassMatrix { consistent, lumped };

namespace detail {

/// factor · ∫ N_a N_b dV · x of an element.
template <class T, class Laws>
struct MassKernel {
  T factor;
  template <int G, class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<G>, V const& rest, V const& x) const {
    return factor * volume_product<typename Laws::template formulation<G>::element>(rest, x);
  }
};

/// out_i += factor m_i x_i.
template <class T, int Dim>
struct AddLumped {
  NodeField<T, Dim> out;
  NodeField<T const, Dim> x;
  T const* mass;
  T factor;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (mass[i] > T(0)) out.set(i, out.at(i) + (factor * mass[i]) * x.at(i));
  }
};

/// out += factor M x at nodes, where x has the values of slaves; their own rows are not handed on. `out` has scratch rows.
template <class Parts>
void add_mass_product(Parts const& parts, MassMatrix kind, double factor,
                      typename Parts::ConstField x, typename Parts::Field out) {
  using T = typename Parts::T;
  if (kind == MassMatrix::lumped) {
    parts.backend.for_each(
        parts.layout.rows,
        AddLumped<T, Parts::dim>{out, x, parts.layout.mass.data(), static_cast<T>(factor)});
    return;
  }
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    parts.backend.template accumulate<Table::groups>(
        table.elements,
        MassKernel<T, typename Table::Laws>{static_cast<T>(factor * parts.material.density)}, out,
        parts.rest(), x);
  });
}

}  // namespace detail
}  // namespace pliant
