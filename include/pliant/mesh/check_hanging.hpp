#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pliant/mesh/outer_sides.hpp>

// Nodes that hang on the boundary's edges and flat sides.
namespace pliant::detail {

/// Where a point lies on an edge, or on a side between two edges, that begin at one corner.
enum class Lies { elsewhere, on_first, on_second, between };

/// The edges of a side at one of its corners, relative to it; plane meshes have only the first.
template <std::size_t Dim>
class CornerOfSide {
 public:
  using Vector = std::array<double, Dim>;
  CornerOfSide(Vector const& first, Vector const& second, bool is_triangle)
      : first_(first),
        second_(second),
        a_(product(first, first)),
        b_(product(first, second)),
        c_(product(second, second)),
        is_triangle_(is_triangle) {
    for (double x : first) reach_ = std::max(reach_, std::abs(x));
  }
  /// The largest coordinate of the first edge.
  double reach() const { return reach_; }

  /// Where `x`, relative to the corner too, lies on the side.
  Lies where(Vector const& x) const {
    double const xa = product(x, first_);
    double s = xa / a_, t = 0;
    if constexpr (Dim == 3) {
      double const xc = product(x, second_), det = a_ * c_ - b_ * b_;
      s = (xa * c_ - xc * b_) / det;
      t = (xc * a_ - xa * b_) / det;
    }
    constexpr double zero = 1e-6;
    double const most = is_triangle_ ? s + t : std::max(s, t);
    if (!(s > -zero && t > -zero && most < 1 - zero && std::max(s, t) > zero))
      return Lies::elsewhere;
    if (t < zero) t = 0;
    if (s < zero) s = 0;
    double off = 0;
    for (std::size_t k = 0; k < Dim; ++k) {
      double const o = x[k] - s * first_[k] - t * second_[k];
      off += o * o;
    }
    if (!(off < 1e-18 * std::max(a_, c_))) return Lies::elsewhere;
    return t == 0 ? Lies::on_first : s == 0 ? Lies::on_second : Lies::between;
  }

 private:
  static double product(Vector const& p, Vector const& q) {
    double sum = 0;
    for (std::size_t k = 0; k < Dim; ++k) sum += p[k] * q[k];
    return sum;
  }

  Vector first_, second_;
  double a_, b_, c_, reach_ = 0;
  bool is_triangle_;
};

/// Looks for nodes that hang on outer sides.
template <class M>
class HangingCheck {
  static constexpr std::size_t dim = M::dim;
  using Side = Facet<M::dim>;

 public:
  explicit HangingCheck(M const& mesh)
      : mesh_(mesh), known_(mesh.nodes.size(), 0), sides_(mesh::outer_sides(mesh)) {
    for (auto const& slave : mesh.slaves) known_[static_cast<std::size_t>(slave.node)] = 1;
    std::vector<Index> corner;
    for (std::size_t s = 0; s < sides_.size(); ++s)
      for (std::size_t c = 0; c < sides_[s].corners(); ++c) {
        corner.push_back(sides_[s][c]);
        side_of_corner_.push_back(static_cast<Index>(s));
      }
    at_node_ = group_by_key(corner, static_cast<Index>(mesh.nodes.size()));
  }
  void operator()() const {
    for_each_on_host(static_cast<Index>(sides_.size()), 1024, [&](Index s) {
      auto const& side = sides_[static_cast<std::size_t>(s)];
      for (std::size_t c = 0; c < side.corners(); ++c) check_corner(side, c);
    });
  }

 private:
  std::array<double, dim> from(Index origin, Index node) const {
    auto x = mesh_.nodes[static_cast<std::size_t>(node)];
    for (std::size_t k = 0; k < dim; ++k) x[k] -= mesh_.nodes[static_cast<std::size_t>(origin)][k];
    return x;
  }
  /// Looks at the nodes of other sides that share a corner.
  void check_corner(Side const& side, std::size_t c) const {
    std::size_t const n = side.corners();
    Index const a = side[c], b = side[(c + 1) % n], d = side[(c + n - 1) % n];
    CornerOfSide<dim> const corner(from(a, b), from(a, d), n == 3);
    auto const at = static_cast<std::size_t>(a);
    for (Index k = at_node_.first[at]; k < at_node_.first[at + 1]; ++k) {
      auto const& other = sides_[static_cast<std::size_t>(
          side_of_corner_[static_cast<std::size_t>(at_node_.order[static_cast<std::size_t>(k)])])];
      if (&other == &side) continue;
      for (Index node : other) {
        if (std::find(side.begin(), side.end(), node) != side.end()) continue;
        auto const lies = corner.where(from(a, node));
        if (lies == Lies::elsewhere || known_[static_cast<std::size_t>(node)] != 0 ||
            is_lip(side, node, corner.reach()))
          continue;
        std::string on = message({"edge from node ", a, " to node "});
        on += message({lies == Lies::on_second ? d : b});
        if (lies == Lies::between)
          on = message({"side between the nodes ", b, ", ", a, " and ", d});
        throw Error("mesh: node ", node, " at ", mesh_.nodes[static_cast<std::size_t>(node)],
                    " hangs on the ", on,
                    "; list it in mesh.slaves with its masters, or split the element beside it");
      }
    }
  }
  /// Whether the side has a node at the same place: then both are of the lips of a slit.
  bool is_lip(Side const& side, Index node, double reach) const {
    return std::any_of(side.begin(), side.end(), [&](Index own) {
      auto const x = from(own, node);
      return std::ranges::all_of(x, [&](double apart) { return std::abs(apart) <= 1e-9 * reach; });
    });
  }

  M const& mesh_;
  std::vector<std::uint8_t> known_;  // slaves
  std::vector<Side> sides_;
  std::vector<Index> side_of_corner_;
  GroupedByKey at_node_;  // corners
};

/// Throws Error where a node that is not listed as a slave lies inside an edge or a flat side of the boundary that
/// does not have it, beside a corner that they share: the mesh would come apart there.
template <class M>
void check_hanging(M const& mesh) {
  HangingCheck<M>{mesh}();
}

}  // namespace pliant::detail
