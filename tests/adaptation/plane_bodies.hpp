#pragma once

#include <map>
#include <optional>

#include "support/formulations.hpp"

// Plane bodies to refine, and what can be seen of their hanging nodes from positions alone.
namespace pliant::test {

using TriLinear = Formulation<Tri3, Gauss<1>, Hooke>;
using TriRubber = Formulation<Tri3, Gauss<1>, NeoHookean>;
using QuadLinear = Formulation<Quad4, Gauss<2>, Hooke>;
using QuadRubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <Backend B>
auto plane_body(B const& backend, Mesh<Tri3> const& mesh) {
  return Body{backend, mesh, soft, Group<TriRubber>{}, Group<TriLinear>{}};
}
template <Backend B>
auto plane_body(B const& backend, Mesh<Quad4> const& mesh) {
  return Body{backend, mesh, soft, Group<QuadRubber>{}, Group<QuadLinear>{}};
}
template <Backend B>
auto plane_body(B const& backend, Mesh<Tri3, Quad4> const& mesh) {
  return Body{backend,
              mesh,
              soft,
              Group<TriRubber>{},
              Group<TriLinear>{},
              Group<QuadRubber>{},
              Group<QuadLinear>{}};
}

/// Calls visit(backend, mesh) for irregular meshes of triangles, of quadrilaterals and of both: all of them on the main
/// backend, the mixed one on the other of a CPU.
template <class Bs, class Visit>
void on_plane_meshes(int n, Visit const& visit) {
  on_each_backend<Bs>([&]<class B>(B const& backend) {
    if constexpr (runs_all<B>) {
      SECTION("Tri3") { visit(backend, distorted_mesh<Tri3>(n)); }
      SECTION("Quad4") { visit(backend, distorted_mesh<Quad4>(n)); }
    }
    SECTION("Tri3 and Quad4") { visit(backend, mixed_mesh(n)); }
  });
}

using Marks = std::vector<std::vector<Index>>;

/// Some elements of each type at random, at least one in all.
template <class TheBody>
Marks random_marks(TheBody const& body, Random& random, std::size_t one_in) {
  Marks marks;
  body.parts().for_each_type([&](auto const& table, auto const&) {
    marks.emplace_back();
    for (Index e = 0; e < table.count(); ++e)
      if (random.below(one_in) == 0) marks.back().push_back(e);
  });
  for (auto const& list : marks)
    if (!list.empty()) return marks;
  std::size_t which = 0;
  bool done = false;
  body.parts().for_each_type([&](auto const& table, auto const&) {
    if (!done && table.count() > 0) {
      marks[which].push_back(0);
      done = true;
    }
    ++which;
  });
  return marks;
}

template <Element E, class M>
inline constexpr bool has_elements = false;
template <Element E, Element... Es>
inline constexpr bool has_elements<E, Mesh<Es...>> = (std::same_as<E, Es> || ...);

/// Puts the marked elements into the linear groups, or into the others.
enum class Put { linear, rubber };
template <class TheBody>
void put(TheBody& body, Marks const& marks, Put where) {
  auto const into = [&]<class F>(List<F>, std::vector<Index> const& elements) {
    body.template assign<F>(elements);
  };
  using M = typename TheBody::mesh_type;
  if constexpr (has_elements<Tri3, M>)
    where == Put::linear ? into(List<TriLinear>{}, marks.front())
                         : into(List<TriRubber>{}, marks.front());
  if constexpr (has_elements<Quad4, M>)
    where == Put::linear ? into(List<QuadLinear>{}, marks.back())
                         : into(List<QuadRubber>{}, marks.back());
}

template <class TheBody>
std::size_t element_count(TheBody const& body) {
  std::size_t count = 0;
  body.parts().for_each_type(
      [&](auto const& table, auto const&) { count += static_cast<std::size_t>(table.count()); });
  return count;
}

/// Calls visit(E{}, e, nodes) for each element of a mesh.
template <Element... Es, class Visit>
void for_each_element(Mesh<Es...> const& mesh, Visit const& visit) {
  auto const of_type = [&]<Element E>(E) {
    auto const& elements = mesh.template elements<E>();
    for (std::size_t e = 0; e < elements.size(); ++e) visit(E{}, e, elements[e]);
  };
  (of_type(Es{}), ...);
}

inline Point<2> middle(Point<2> const& a, Point<2> const& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
}

/// A node in the middle of a side of an element that has no corner there.
struct Hanging {
  Index node;
  std::array<Index, 2> side;
};

/// The hanging nodes, found by position: midpoints are exact to the bit, for refinement and this
/// function compute them alike. Nothing where a side has a node at a quarter: two levels at once.
template <class M>
std::optional<std::vector<Hanging>> hanging_nodes(M const& mesh) {
  std::map<Point<2>, Index> at;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!at.emplace(mesh.nodes[i], static_cast<Index>(i)).second) return std::nullopt;
  std::vector<Hanging> hanging;
  bool graded = true;
  for_each_element(mesh, [&](auto, std::size_t, auto const& nodes) {
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      Index const a = nodes[s], b = nodes[(s + 1) % nodes.size()];
      Point<2> const from = mesh.nodes[static_cast<std::size_t>(a)],
                     to = mesh.nodes[static_cast<std::size_t>(b)], half = middle(from, to);
      if (auto const found = at.find(half); found != at.end())
        hanging.push_back({found->second, {a, b}});
      if (at.contains(middle(from, half)) || at.contains(middle(half, to))) graded = false;
    }
  });
  if (!graded) return std::nullopt;
  return hanging;
}

/// The largest distance of a value at a hanging node from the mean of those at its side's ends.
inline double gap(std::vector<Hanging> const& hanging, FieldOf<2> const& field) {
  double largest = 0;
  for (auto const& [node, side] : hanging)
    for (std::size_t k = 0; k < 2; ++k)
      largest = std::max(largest, std::abs(field[static_cast<std::size_t>(node)][k] -
                                           (field[static_cast<std::size_t>(side[0])][k] +
                                            field[static_cast<std::size_t>(side[1])][k]) /
                                               2));
  return largest;
}

template <class TheBody>
Point<2> momentum(TheBody& body) {
  auto p = body.velocities();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (double& x : p[i]) x *= body.parts().layout.mass_list()[i];
  return total(p);
}

template <class TheBody>
inline constexpr double epsilon_of =
    double{std::numeric_limits<typename TheBody::scalar>::epsilon()};

}  // namespace pliant::test
