#pragma once

#include <tuple>

#include <pliant/backend/backend.hpp>
#include <pliant/body/group.hpp>
#include <pliant/formulation/physics.hpp>

// The adapters between the element loops of a backend, which speak of group numbers and gathered
// values, and the physics of a formulation.
namespace pliant {

/// The formulations of one element type and their laws in the precision of the kernels.
template <class T, class... Fs>
struct GroupLaws {
  template <int G>
  using formulation = std::tuple_element_t<G, std::tuple<Fs...>>;

  std::tuple<decltype(prepared<Fs>(std::declval<typename Fs::template law<T>>()))...> laws;

  template <int G>
  PLIANT_HOST_DEVICE auto const& law() const {
    return std::get<G>(laws);
  }
};

template <class Laws, Geometry How = Geometry::isoparametric>
struct ForceKernel {
  Laws groups;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& rest, V const& u) const {
    return force<typename Laws::template formulation<G>, How>(groups.template law<G>(), rest, u);
  }
};

/// Adds factor · ∂F/∂u · du.
template <class T, class Laws, Geometry How = Geometry::isoparametric>
struct TangentKernel {
  Laws groups;
  T factor;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& rest, V const& u, V const& du) const {
    return factor * force_change<typename Laws::template formulation<G>, How>(
                        groups.template law<G>(), rest, u, du);
  }
};

template <class Laws, Geometry How = Geometry::isoparametric>
struct EnergyKernel {
  Laws groups;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& rest, V const& u) const {
    return energy<typename Laws::template formulation<G>, How>(groups.template law<G>(), rest, u);
  }
};

}  // namespace pliant
