#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

#include <pliant/mesh/mesh.hpp>

namespace pliant::mesh {

/// The same mesh with the element types To, of which it has no elements where it had none: for elements of types that
/// raise, lower, split or merge makes while a body moves. To has all types of the mesh.
///
///   auto const mesh = mesh::with_types<Tri3, Tri6>(mesh::rectangle<Tri3>(...));
template <Element... To, Element... From>
Mesh<To...> with_types(Mesh<From...> mesh) {
  Mesh<To...> more{std::move(mesh.nodes), {}, std::move(mesh.boundaries), std::move(mesh.slaves)};
  auto const take = [&]<Element E>(std::type_identity<E>) {
    static_assert((std::same_as<E, To> || ...), "with_types: name all types of the mesh");
    more.template elements<E>() = std::move(mesh.template elements<E>());
  };
  (take(std::type_identity<From>{}), ...);
  return more;
}

}  // namespace pliant::mesh
