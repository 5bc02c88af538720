#pragma once

#include <pliant/mesh/with_types.hpp>

#include "support/meshes.hpp"
#include "topology/mixed_meshes.hpp"

// Bodies of several element types, and random changes of their meshes and groups.
namespace pliant::test {

struct ChangingPlane {
  using First = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
  using Second = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using Quads = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Quadratic = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
  static constexpr std::size_t most_nodes = 600;
  template <class B>
  static auto body(B const& backend) {
    return body(backend, mesh::with_types<Tri3, Quad4, Quad9>(mixed_mesh(5, 1)));
  }
  template <class B>
  static auto body(B const& backend, Mesh<Tri3, Quad4, Quad9> const& mesh) {
    return Body(backend, mesh, soft, Group<First>{}, Group<Second>{}, Group<Quads>{},
                Group<Quadratic>{});
  }
};
struct ChangingSolid {
  using First = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  using Second = Formulation<Tet4, Gauss<1>, NeoHookean>;
  using Quadratic = Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>;
  using Hexes = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
  using Pyramids = Formulation<Pyramid5, Gauss<2>, SaintVenantKirchhoff>;
  static constexpr std::size_t most_nodes = 900;
  template <class B>
  static auto body(B const& backend) {
    return body(backend, mesh::with_types<Tet4, Tet10, Hex8, Pyramid5>(distorted_mesh<Hex8>(3)));
  }
  template <class B>
  static auto body(B const& backend, Mesh<Tet4, Tet10, Hex8, Pyramid5> const& mesh) {
    return Body(backend, mesh, soft, Group<First>{}, Group<Second>{}, Group<Quadratic>{},
                Group<Hexes>{}, Group<Pyramids>{});
  }
};

/// The marks that are for types of which wanted(E{}).
template <class TheBody, class Wanted>
std::vector<std::vector<Index>> some_where(TheBody const& body, std::size_t one_in, Random& random,
                                           Wanted const& wanted) {
  auto lists = some(body, one_in, random, -1);
  detail::for_each_type_of<std::remove_cvref_t<decltype(body.mesh())>>(
      [&](auto element, std::size_t type) {
        if (!wanted(element)) lists[type].clear();
      });
  return lists;
}
constexpr auto of_degree(int degree) {
  return [degree]<Element E>(E) { return E::degree == degree; };
}
template <class TheBody>
constexpr auto can_be_raised() {
  return []<Element E>(E) {
    return E::degree == 1 && converted_type<E, typename TheBody::mesh_type> != no_type;
  };
}
constexpr auto can_be_split() {
  return []<Element E>(E) { return !std::is_void_v<SplitInto<E>>; };
}
constexpr auto can_be_merged() {
  return []<Element E>(E) { return is_part<E>; };
}

/// One of all changes, at random.
template <class P, class TheBody>
void change(TheBody& body, Random& random) {
  switch (random.below(8)) {
    case 0:
    case 1:
      refine(body, some(body, 12, random, -1), 3);
      break;
    case 2:
      raise(body, some_where(body, 8, random, can_be_raised<TheBody>()),
            {.ring = static_cast<int>(random.below(2))});
      break;
    case 3:
      lower(body, some_where(body, 3, random, of_degree(2)));
      break;
    case 4:
      split(body, some_where(body, 4, random, can_be_split()),
            {.triangles = random.below(2) == 0 ? 2 : 4});
      break;
    case 5:
      merge(body, some_where(body, 1 + random.below(2), random, can_be_merged()));
      break;
    case 6:
      coarsen(body, some(body, 1 + random.below(2), random, -1));
      break;
    default: {
      auto const& triangles = body.mesh().template elements<typename P::First::element>();
      std::vector<Index> list;
      for (Index e = 0; e < static_cast<Index>(triangles.size()); ++e)
        if (random.below(3) == 0) list.push_back(e);
      if (random.below(2) == 0)
        body.template assign<typename P::First>(list);
      else
        body.template assign<typename P::Second>(list);
    }
  }
}
/// Back to the mesh of the beginning.
template <class TheBody>
void undo(TheBody& body) {
  Random random(1);
  for (std::size_t changed = 1; changed > 0;) {
    changed = lower(body, some_where(body, 1, random, of_degree(2))).lowered;
    changed += merge(body, some_where(body, 1, random, can_be_merged())).merged;
    changed += coarsen(body, all(body, -1)).merged;
  }
}

}  // namespace pliant::test
