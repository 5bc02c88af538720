#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/mesh/mesh.hpp>

// A force term is whatever pulls at nodes: the element groups of a body, pressures, what a user adds.
namespace pliant {

/// Where a force term is asked: positions at rest and displacements of all nodes, in a backend's memory.
template <class T, int Dim>
struct Placement {
  NodeField<T const, Dim> rest, u;  // (nodes, dim), m; rest relative to the body's middle
};

/// What a force term makes of one of its elements, on the host in double precision.
struct ElementMatrix {
  std::span<Index const> nodes;   // internal numbers
  double energy;                  // J; 0 where a term has none
  std::span<double const> force;  // (nodes, dim), N
  std::span<double const>
      stiffness;  // −∂force/∂u, rows and columns over (node, dim); empty if not asked
};

/// A force term of a body on backend B in Dim dimensions.
///   scratch_nodes()                   rows that a field to accumulate into needs behind the nodes
///   energy(b, at)                     J; 0 for a term that has none
///   has_energy()                      whether the force is −∂energy/∂u
///   add_force(b, at, f)               f += force
///   add_tangent_product(b, c, at, du, f)   f += c ∂force/∂u du
///   add_diagonal(b, at, k, d)         d += column k of each node's own block of −∂force/∂u
///   add_row_sums(b, at, r)            r += Σ_j |∂force_i/∂u_j|, from which a bound of the stable step
///                                     follows (unassembled Gershgorin discs)
template <class F, class B, int Dim>
concept ForceTerm =
    Backend<B> &&
    requires(F const& term, B const& backend, Placement<typename B::scalar, Dim> const& at,
             NodeField<typename B::scalar const, Dim> du, NodeField<typename B::scalar, Dim> out) {
      { term.scratch_nodes() } -> std::convertible_to<Index>;
      { term.energy(backend, at) } -> std::convertible_to<double>;
      { term.has_energy() } -> std::convertible_to<bool>;
      term.add_force(backend, at, out);
      term.add_tangent_product(backend, typename B::scalar(1), at, du, out);
      term.add_diagonal(backend, at, 0, out);
      term.add_row_sums(backend, at, out);
    };

/// A force term behind virtual functions, so that bodies compile only the terms that they are given.
template <Backend B, int Dim>
class AnyForceTerm {
 public:
  using T = typename B::scalar;
  using At = Placement<T, Dim>;
  using Field = NodeField<T, Dim>;
  using ConstField = NodeField<T const, Dim>;

  virtual ~AnyForceTerm() = default;
  virtual Index scratch_nodes() const = 0;
  virtual bool has_energy() const = 0;
  virtual double energy(B const& backend, At const& at) const = 0;
  virtual void add_force(B const& backend, At const& at, Field f) const = 0;
  virtual void add_tangent_product(B const& backend, T factor, At const& at, ConstField du,
                                   Field f) const = 0;
  virtual void add_diagonal(B const& backend, At const& at, int column, Field diagonal) const = 0;
  virtual void add_row_sums(B const& backend, At const& at, Field rows) const = 0;
  /// Calls visit for each element; rest(node), u(node) give a node's place, relative to the body's middle,
  /// and displacement.
  using HostField = std::function<Point<Dim>(Index)>;
  virtual void for_each_element(HostField const& rest, HostField const& u, bool with_stiffness,
                                std::function<void(ElementMatrix const&)> const& visit) const = 0;
};

}  // namespace pliant
