#pragma once

#include <array>
#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant::detail {

/// Numbers what a division of leaves makes, in a backend's memory.
template <Backend B>
class PartNumbers {
 public:
  explicit PartNumbers(B const& backend) : counts_(backend, 4) {}

  /// Finds and numbers what n leaves make, `parts`, behind what there is; returns how many nodes, edges, sides and cells that are.
  /// Waits.
  std::array<Index, 4> operator()(B const& backend, DivisionView const& planned, LeafParts* parts,
                                  Index n, TreeSizes const& sizes) {
    for (auto& before : before_) grow(backend, before, static_cast<std::size_t>(n) + 1);
    auto* const nodes = before_[0].data();
    auto* const edges = before_[1].data();
    auto* const sides = before_[2].data();
    auto* const cells = before_[3].data();
    in_turn(backend, LoopStep{n, ClaimShared{planned}}, LoopStep{n, FindParts{planned}},
            ScanStep{n, CountOf<&LeafParts::nodes>{parts}, nodes},
            ScanStep{n, CountOf<&LeafParts::edges>{parts}, edges},
            ScanStep{n, CountOf<&LeafParts::sides>{parts}, sides},
            ScanStep{n, CountOf<&LeafParts::cells>{parts}, cells},
            LoopStep{n + 1,
                     NumberParts{parts, {nodes, edges, sides, cells}, sizes, n, counts_.data()}});
    backend.synchronize();
    return counts_.template first<4>();
  }

 private:
  std::array<typename B::template Array<Index>, 4> before_;
  ReadBack<B, Index> counts_;
};

}  // namespace pliant::detail
