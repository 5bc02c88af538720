#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <pliant/backend/host_tasks.hpp>
#include <pliant/constraint/interpolation.hpp>
#include <pliant/solver/element_tangents.hpp>
#include <pliant/solver/linear/block_matrix.hpp>
#include <pliant/solver/linear/positive_part.hpp>

namespace pliant {

/// What is assembled; the rest of what it is put into is left empty.
enum class Assemble { energy_and_force, stiffness, stiffness_too };

namespace detail {

/// As Assembled, with the stiffness in blocks of a node and a node.
template <int Dim>
struct AssembledBlocks {
  double energy = 0;                // J
  Eigen::VectorXd force;            // N
  BlockMatrix<Dim, Dim> stiffness;  // N/m; keeps its pattern from one assembly to the next
};

/// Adds elements to sums over nodes; what belongs to slaves goes to their masters. Each row adds up its elements in
/// their order, whatever the number of threads.
template <int Dim>
class Assembler {
 public:
  /// The stiffness of `sum` has room for all elements that are added by add_elements.
  Assembler(HostTasks const& tasks, Interpolation const& interpolation, Assemble what, Index nodes,
            AssembledBlocks<Dim>& sum, ElementTangents tangents = ElementTangents::exact)
      : tasks_(tasks),
        interpolation_(interpolation),
        with_force_(what != Assemble::stiffness),
        with_stiffness_(what != Assemble::energy_and_force),
        tangents_(tangents),
        sum_(sum) {
    sum_.energy = 0;
    sum_.force.setZero(with_force_ ? Eigen::Index{Dim} * nodes : 0);
    if (with_stiffness_) sum_.stiffness.clear_values();
  }
  bool with_force() const { return with_force_; }
  bool with_stiffness() const { return with_stiffness_; }

  /// Elements e < count with the nodes nodes_of(e), a fixed number. evaluate(e, force, stiffness) writes an element's
  /// force, (nodes, Dim), and stiffness, rows and columns over (node, direction), where these are not null (they are
  /// zero before), and returns its energy.
  template <class NodesOf, class Evaluate>
  void add_elements(Index count, NodesOf const& nodes_of, Evaluate const& evaluate) {
    if (count == 0) return;
    auto const width = Dim * std::size(nodes_of(Index{0}));
    // Some megabytes, which stay in caches that cores share.
    auto const at_once =
        static_cast<Index>(std::max<std::size_t>((std::size_t{1} << 20) / (width * width), 16));
    auto const room = static_cast<std::size_t>(std::min(count, at_once));
    energy_.resize(room);
    force_.resize(with_force_ ? room * width : 0);
    stiffness_.resize(with_stiffness_ ? room * width * width : 0);
    for (Index first = 0; first < count; first += at_once) {
      Index const n = std::min(at_once, count - first);
      auto const force = [&](Index e) {
        return with_force_ ? force_.data() + static_cast<std::size_t>(e) * width : nullptr;
      };
      auto const stiffness = [&](Index e) {
        return with_stiffness_ ? stiffness_.data() + static_cast<std::size_t>(e) * width * width
                               : nullptr;
      };
      tasks_.in_parts(n, 4, [&](Index from, Index to) {
        for (Index e = from; e < to; ++e) {
          if (with_force_) std::fill_n(force(e), width, 0.0);
          if (with_stiffness_) std::fill_n(stiffness(e), width * width, 0.0);
          energy_[static_cast<std::size_t>(e)] = evaluate(first + e, force(e), stiffness(e));
          if (with_stiffness_) project(stiffness(e), width);
        }
      });
      for (Index e = 0; e < n; ++e) sum_.energy += energy_[static_cast<std::size_t>(e)];
      Index const shares = n < 8 ? 1 : tasks_.threads();
      tasks_(shares, [&](Index share) {
        std::vector<Master> masters;
        for (Index e = 0; e < n; ++e)
          add_to_rows(nodes_of(first + e), force(e), stiffness(e), masters, share, shares);
      });
    }
  }
  /// Makes a symmetric tangent positive semidefinite where that is wanted.
  void project(double* stiffness, std::size_t width) const {
    auto const size = static_cast<Eigen::Index>(width);
    if (tangents_ == ElementTangents::positive_semidefinite)
      keep_positive_part(Eigen::MatrixXd::Map(stiffness, size, size));
  }
  /// One element, of nodes that need not have a place in the stiffness yet: see `lacking`.
  template <class Nodes>
  void add_element(Nodes const& nodes, double energy, double const* force,
                   double const* stiffness) {
    sum_.energy += energy;
    if (with_stiffness_ && !has_room_for(nodes)) {
      lacking_.emplace_back(nodes.begin(), nodes.end());
      return;
    }
    add_to_rows(nodes, with_force_ ? force : nullptr, with_stiffness_ ? stiffness : nullptr,
                masters_, 0, 1);
  }
  /// Nodes of elements that were not added, since the stiffness has no room for them.
  std::vector<std::vector<Index>> const& lacking() const { return lacking_; }

 private:
  struct Master {
    Index node;
    double weight;
    std::size_t of;  // place among the element's nodes
  };

  template <class Nodes>
  void list_masters(Nodes const& nodes, std::vector<Master>& masters) const {
    masters.clear();
    std::size_t of = 0;
    for (Index node : nodes) {
      interpolation_.for_each_master(node, [&](Index master, double weight) {
        masters.push_back({master, weight, of});
      });
      ++of;
    }
  }
  template <class Nodes>
  bool has_room_for(Nodes const& nodes) {
    list_masters(nodes, masters_);
    for (auto const& i : masters_)
      for (auto const& j : masters_)
        if (sum_.stiffness.find(i.node, j.node) < 0) return false;
    return true;
  }
  /// The rows i with i mod shares = share.
  template <class Nodes>
  void add_to_rows(Nodes const& nodes, double const* force, double const* stiffness,
                   std::vector<Master>& masters, Index share, Index shares) {
    list_masters(nodes, masters);
    auto const width = Dim * std::size(nodes);
    for (auto const& i : masters) {
      if (shares > 1 && i.node % shares != share) continue;
      if (force != nullptr)
        for (std::size_t k = 0; k < Dim; ++k)
          sum_.force[Eigen::Index{Dim} * i.node + static_cast<Eigen::Index>(k)] +=
              i.weight * force[Dim * i.of + k];
      if (stiffness == nullptr) continue;
      for (auto const& j : masters) {
        double const weight = i.weight * j.weight;
        double* const block = sum_.stiffness.at(sum_.stiffness.find(i.node, j.node));
        double const* const from = stiffness + width * Dim * i.of + Dim * j.of;
        for (std::size_t p = 0; p < Dim; ++p)
          for (std::size_t q = 0; q < Dim; ++q) block[Dim * p + q] += weight * from[width * p + q];
      }
    }
  }

  HostTasks const& tasks_;
  Interpolation const& interpolation_;
  bool with_force_, with_stiffness_;
  ElementTangents tangents_;
  AssembledBlocks<Dim>& sum_;
  std::vector<double> energy_, force_, stiffness_;  // of the elements that are added at once
  std::vector<Master> masters_;
  std::vector<std::vector<Index>> lacking_;
};

}  // namespace detail
}  // namespace pliant
