#pragma once

#include <array>
#include <string>
#include <vector>

// What a program and a library that computes with deal.II hand each other. The library is loaded when the program
// runs, so that deal.II by several compilers is timed beside Pliant by one.
namespace pliant::bench {

/// A mesh, in the order in which it is to be kept, and what it is made of.
struct PeerMesh {
  bool simplex;                              // tetrahedra, or else hexahedra
  int degree;                                // of the shape functions
  std::vector<std::array<double, 3>> nodes;  // m
  std::vector<int> elements;                 // (elements, nodes of one)
  std::vector<std::array<double, 3>>
      places;         // of an element's nodes in its cell: [0, 1]³ or corners 0, e₀, e₁, e₂
  double lambda, mu;  // Lamé's parameters, Pa
};

enum class PeerLaw { saint_venant_kirchhoff, neo_hookean };

/// Nodal forces of another library's element loops.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  /// By the mesh's numbers of nodes, m: at which forces and tangents are taken, and what a tangent is multiplied by.
  virtual void set_displacements(std::vector<std::array<double, 3>> const& u,
                                 std::vector<std::array<double, 3>> const& du) = 0;
  /// −∂W/∂u, or −∂²W/∂u² du; the second kind reads displacement gradients that set_displacements stored.
  virtual void force(PeerLaw law) = 0;
  virtual void tangent_product(PeerLaw law) = 0;
  /// Of the last product, by the mesh's numbers, N.
  virtual std::vector<std::array<double, 3>> result() const = 0;
};

/// The one function that such a library exports; the caller deletes what it makes.
using MakePeer = Peer*(PeerMesh const&);
inline constexpr char const* make_peer_name = "pliant_bench_make_peer";

}  // namespace pliant::bench
