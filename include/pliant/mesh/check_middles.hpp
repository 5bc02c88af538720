#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <string>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/describe.hpp>
#include <pliant/topology/compose.hpp>

// Elements that share the corners of an edge or a face, and the nodes that they have in the middle of it.
namespace pliant::detail {

/// The edges of cells, or the faces of solid ones.
struct EdgesOfCell {
  static constexpr char const* name = "edge ";
  static constexpr std::size_t corners = 2;
  template <class Cell>
  static constexpr auto of() {
    return Cell::edges();
  }
};
struct FacesOfCell {
  static constexpr char const* name = "face ";
  static constexpr std::size_t corners = 4;  // or 3
  template <class Cell>
  static constexpr auto of() {
    return Cell::sides();
  }
};

/// The middle of an edge or face, on the cell, and the element's node there; −1: none.
template <Element E>
struct PlaceOfMiddle {
  Vector<double, E::dim> place{};
  int node = -1;

  template <std::size_t N>
  static constexpr PlaceOfMiddle of(std::array<int, N> const& corners) {
    PlaceOfMiddle middle;
    int count = 0;
    for (int corner : corners)
      if (corner >= 0) {
        middle.place = middle.place + E::cell::corner(corner);
        ++count;
      }
    middle.place = 1.0 / count * middle.place;
    for (int a = E::cell::corners; a < E::nodes; ++a) {
      auto const apart = E::place(a) - middle.place;
      if (dot(apart, apart) < 1e-9) middle.node = a;
    }
    return middle;
  }
};

/// What an element has in the middle of one of its edges or faces.
template <std::size_t Corners>
struct Middle {
  std::array<Index, Corners> corners;  // ascending, −1 before those of a triangle
  Index node;                          // −1: none
  int type, part;                      // of the mesh's types; of the cell's edges or faces
  Index element;

  auto operator<=>(Middle const&) const = default;
};

/// Compares what elements have in the middles of shared edges, or faces.
template <class PartsOfCell, class M>
class MiddleCheck;

template <class PartsOfCell, Element... Es>
class MiddleCheck<PartsOfCell, Mesh<Es...>> {
  using M = Mesh<Es...>;
  using Entry = Middle<PartsOfCell::corners>;

 public:
  explicit MiddleCheck(M const& mesh) : mesh_(mesh) {}

  void operator()() {
    if constexpr ((has_middles<Es>() || ...)) {
      auto const nodes = static_cast<Index>(mesh_.nodes.size());
      auto const by_corner = group_by_key(smallest_corners(), nodes);
      HostParts const parts(nodes, 2048);
      std::vector<std::vector<Index>> differing(static_cast<std::size_t>(parts.count()));
      parts([&](Index first, Index last, int part) {
        std::vector<Entry> seen;
        for (Index corner = first; corner < last; ++corner)
          if (differ(entries_at(by_corner, corner), seen))
            differing[static_cast<std::size_t>(part)].push_back(corner);
      });
      for (auto const& of_part : differing)
        for (Index corner : of_part) compare(entries_at(by_corner, corner));
    }
  }

 private:
  template <Element E>
  static constexpr auto parts_of = PartsOfCell::template of<typename E::cell>();
  template <Element E>
  static constexpr bool has_middles() {
    for (auto const& part : parts_of<E>)
      if (PlaceOfMiddle<E>::of(part).node >= 0) return true;
    return false;
  }

  /// Of all parts of all elements, type by type.
  std::vector<Index> smallest_corners() const {
    std::vector<Index> smallest(
        ((mesh_.template elements<Es>().size() * parts_of<Es>.size()) + ...));
    std::size_t begin = 0;
    auto const add = [&]<Element E>(E) {
      auto const& elements = mesh_.template elements<E>();
      for_each_on_host(static_cast<Index>(elements.size()), few_elements(E::nodes), [&](Index i) {
        auto const e = static_cast<std::size_t>(i);
        for (std::size_t p = 0; p < parts_of<E>.size(); ++p) {
          Index least = static_cast<Index>(mesh_.nodes.size());
          for (int corner : parts_of<E>[p])
            if (corner >= 0) least = std::min(least, elements[e][static_cast<std::size_t>(corner)]);
          smallest[begin + e * parts_of<E>.size() + p] = least;
        }
      });
      begin += elements.size() * parts_of<E>.size();
    };
    (add(Es{}), ...);
    return smallest;
  }
  /// visit(entry) for the entries of a corner, in the order of elements.
  auto entries_at(GroupedByKey const& by_corner, Index corner) const {
    return [this, &by_corner, corner](auto const& visit) {
      auto const at = static_cast<std::size_t>(corner);
      for (Index k = by_corner.first[at]; k < by_corner.first[at + 1]; ++k)
        visit(entry(static_cast<std::size_t>(by_corner.order[static_cast<std::size_t>(k)])));
    };
  }
  /// Of number `place` among all.
  Entry entry(std::size_t place) const {
    Entry found{{}, -1, -1, 0, 0};
    int type = 0;
    auto const look_at = [&]<Element E>(E) {
      auto const& elements = mesh_.template elements<E>();
      std::size_t const count = elements.size() * parts_of<E>.size();
      if (found.type < 0 && place < count) {
        std::size_t const p = place % parts_of<E>.size(), e = place / parts_of<E>.size();
        found.corners.fill(-1);
        for (std::size_t c = 0; c < parts_of<E>[p].size(); ++c)
          if (int const corner = parts_of<E>[p][c]; corner >= 0)
            found.corners[c] = elements[e][static_cast<std::size_t>(corner)];
        std::sort(found.corners.begin(), found.corners.end());
        if (int const node = middle_of<E>(p).node; node >= 0)
          found.node = elements[e][static_cast<std::size_t>(node)];
        found.type = type;
        found.part = static_cast<int>(p);
        found.element = static_cast<Index>(e);
      }
      place -= count;
      ++type;
    };
    (look_at(Es{}), ...);
    return found;
  }

  /// Whether entries of the same corners have different nodes. `seen` is memory to work in.
  template <class EachEntry>
  static bool differ(EachEntry const& each_entry, std::vector<Entry>& seen) {
    seen.clear();
    bool found = false;
    each_entry([&](Entry const& entry) {
      for (Entry const& other : seen)
        if (other.corners == entry.corners) {
          found = found || other.node != entry.node;
          return;
        }
      seen.push_back(entry);
    });
    return found;
  }
  template <class EachEntry>
  void compare(EachEntry const& each_entry) {
    std::vector<Entry> around;
    each_entry([&](Entry const& entry) { around.push_back(entry); });
    std::sort(around.begin(), around.end());
    auto const* first = around.data();
    for (auto const& entry : around) {
      if (entry.corners != first->corners) first = &entry;
      if (entry.node == first->node) continue;
      if (first->node < 0)
        demand_slave(*first, entry);
      else
        demand_one_place(*first, entry);
    }
  }
  template <Element E>
  static PlaceOfMiddle<E> const& middle_of(std::size_t part) {
    static constexpr auto middles = [] {
      std::array<PlaceOfMiddle<E>, parts_of<E>.size()> all;
      for (std::size_t p = 0; p < all.size(); ++p) all[p] = PlaceOfMiddle<E>::of(parts_of<E>[p]);
      return all;
    }();
    return middles[part];
  }
  /// visit(E) for the element type of an entry.
  template <class Visit>
  static void with_type_of(Entry const& entry, Visit const& visit) {
    int type = 0;
    ((type++ == entry.type ? visit(Es{}) : void()), ...);
  }
  std::string in_words(Entry const& entry) const {
    std::string text;
    with_type_of(entry, [&]<Element E>(E) {
      text = message({PartsOfCell::name, entry.part, " of "}) +
             describe<E>(mesh_, static_cast<std::size_t>(entry.element));
    });
    return text;
  }

  /// Throws Error unless the node of the second element follows the first one's shape functions.
  void demand_slave(Entry const& without, Entry const& with) {
    if (rows_.empty() && !mesh_.slaves.empty()) rows_ = Interpolation(compose(mesh_.slaves));
    std::map<Index, double> off;  // weights of free nodes
    std::string masters;
    bool can_follow = true;
    with_type_of(without, [&]<Element E>(E) {
      auto const shape = E::shape(middle_of<E>(static_cast<std::size_t>(without.part)).place);
      auto const& element = mesh_.template elements<E>()[static_cast<std::size_t>(without.element)];
      for (int a = 0; a < E::nodes; ++a) {
        if (!(std::abs(shape[a]) > 1e-9)) continue;
        Index const node = element[static_cast<std::size_t>(a)];
        can_follow = can_follow && shape[a] > 0;
        masters += message({masters.empty() ? "" : ", ", node, " (", shape[a], ")"});
        rows_.for_each_master(node, [&](Index free, double w) { off[free] += shape[a] * w; });
      }
    });
    rows_.for_each_master(with.node, [&](Index free, double weight) { off[free] -= weight; });
    if (std::ranges::all_of(off, [](auto const& one) { return std::abs(one.second) < 1e-9; }))
      return;
    std::string cure = "give both the same nodes there";
    if (can_follow) cure += ", or list it in mesh.slaves with the masters (and weights) " + masters;
    throw Error("mesh: node ", with.node, " at ", place(with.node), " is in the middle of ",
                in_words(with), ", and ", in_words(without),
                " does not have it: they would come apart there; ", cure);
  }
  /// Throws Error unless the nodes are at one place, as those of the lips of a slit.
  void demand_one_place(Entry const& first, Entry const& second) const {
    auto const &x = place(first.node), &y = place(second.node);
    auto const& corner = place(first.corners.back());
    double apart = 0, reach = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      apart = std::max(apart, std::abs(y[k] - x[k]));
      reach = std::max(reach, std::abs(corner[k] - x[k]));
    }
    if (apart <= 1e-9 * reach) return;
    throw Error("mesh: ", in_words(first), " and ", in_words(second),
                " have the same corners there and the nodes ", first.node, " at ", x, " and ",
                second.node, " at ", y,
                " between them; give both one node, or put the two at one place for a slit");
  }
  Point<M::dim> const& place(Index node) const {
    return mesh_.nodes[static_cast<std::size_t>(node)];
  }

  M const& mesh_;
  Interpolation rows_;  // of the mesh's slaves
};

/// Throws Error where elements share the corners of an edge or a face, one has a node in the middle of it that
/// another does not have, and the node is no slave that goes where the other's shape functions put it: the
/// mesh would come apart there. Two nodes at one place, one of each element, are a slit's.
template <Element... Es>
void check_middles(Mesh<Es...> const& mesh) {
  if constexpr (((Es::nodes > Es::cell::corners) || ...)) {
    MiddleCheck<EdgesOfCell, Mesh<Es...>>{mesh}();
    if constexpr (Mesh<Es...>::dim == 3) MiddleCheck<FacesOfCell, Mesh<Es...>>{mesh}();
  }
}

}  // namespace pliant::detail
