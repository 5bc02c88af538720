#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <vector>

#include <pliant/math/each_once.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/hierarchy.hpp>

// The element types of a mesh, by their place among them.
namespace pliant {

/// The number of an element type that no other takes the place of.
inline constexpr std::size_t no_type = static_cast<std::size_t>(-1);

namespace detail {

template <class E, class M>
struct ConvertedType;
template <class E, Element... Es>
struct ConvertedType<E, Mesh<Es...>> {
  template <class Other>
  static constexpr bool takes_over =
      std::same_as<typename E::cell, typename Other::cell> && E::degree != Other::degree;
  static constexpr std::size_t value = [] {
    std::size_t found = no_type, at = 0;
    ((found == no_type && takes_over<Es> ? found = at++ : at++), ...);
    return found;
  }();
};

}  // namespace detail

/// Elements that take the place of a linear one which is split: triangles of a quadrilateral, pyramids of a hexahedron,
/// tetrahedra of a pyramid.
template <class E>
using SplitInto = std::conditional_t<
    std::same_as<E, Quad4>, Tri3,
    std::conditional_t<std::same_as<E, Hex8>, Pyramid5,
                       std::conditional_t<std::same_as<E, Pyramid5>, Tet4, void>>>;
/// Whether some element is split into such ones.
template <class E>
inline constexpr bool is_part =
    std::same_as<E, Tri3> || std::same_as<E, Pyramid5> || std::same_as<E, Tet4>;

/// Whether elements of one type can take the place of others of another type, or those of these: by degree or by shape.
template <class One, class Other>
inline constexpr bool interchange =
    (std::same_as<typename One::cell, typename Other::cell> && One::degree != Other::degree) ||
    std::same_as<SplitInto<One>, Other> || std::same_as<SplitInto<Other>, One>;

/// The place among a mesh's types of the first on the same cell as E that is of another degree; no_type where there is none.
template <class E, class M>
inline constexpr std::size_t converted_type = detail::ConvertedType<E, M>::value;

namespace detail {

template <class E, class M>
inline constexpr bool has_type = false;
template <class E, Element... Es>
inline constexpr bool has_type<E, Mesh<Es...>> = (std::same_as<E, Es> || ...);

/// Whether elements of some type of a mesh can be split into such of another one.
template <class M>
inline constexpr bool has_other_shapes = false;
template <Element... Es>
inline constexpr bool has_other_shapes<Mesh<Es...>> = (has_type<SplitInto<Es>, Mesh<Es...>> || ...);

/// Tetrahedra are among the children of pyramids.
template <class M>
inline constexpr bool can_be_refined = false;
template <Element... Es>
inline constexpr bool can_be_refined<Mesh<Es...>> =
    (Refinable<Es> && ...) && (!has_type<Pyramid5, Mesh<Es...>> || has_type<Tet4, Mesh<Es...>>);

template <Element E>
bool is_cell_of(TreeCell const& cell) {
  return cell.kind == kind_of<typename E::cell> && cell.has == nodes_on_cell<E>;
}

template <class M>
struct TypesOf;
template <Element... Es>
struct TypesOf<Mesh<Es...>> {
  using tuple = std::tuple<Es...>;
  static constexpr std::size_t count = sizeof...(Es);
  template <class E>
  static constexpr std::size_t place_of = [] {
    std::size_t at = 0, found = no_type;
    ((std::same_as<E, Es> ? found = at++ : at++), ...);
    return found;
  }();
  template <class Visit>
  static void for_each(Visit const& visit) {
    std::size_t type = 0;
    (visit(Es{}, type++), ...);
  }
};
/// The place of an element type among a mesh's; no_type where it is not there.
template <class E, class M>
inline constexpr std::size_t type_in = TypesOf<M>::template place_of<E>;
/// That of the elements which are split into such of a type; no_type where there is none.
template <Element E, class M>
inline constexpr std::size_t whole_type = no_type;
template <Element E, Element... Es>
inline constexpr std::size_t whole_type<E, Mesh<Es...>> = [] {
  std::size_t at = 0, found = no_type;
  ((std::same_as<SplitInto<Es>, E> ? found = at++ : at++), ...);
  return found;
}();
template <class M, std::size_t Type>
using ElementOfType = std::tuple_element<Type, typename TypesOf<M>::tuple>;

/// Calls visit(E{}, place of E among the mesh's types) for each element type.
template <class M, class Visit>
void for_each_type_of(Visit const& visit) {
  TypesOf<M>::for_each(visit);
}

/// How many elements there are, by type.
template <Element... Es>
std::vector<std::size_t> element_counts(Mesh<Es...> const& mesh) {
  return {mesh.template elements<Es>().size()...};
}

}  // namespace detail

}  // namespace pliant
