#pragma once

#include <array>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant::detail {

/// Throws Error when an element has a node that does not exist: tables of elements ask it before they use one.
template <std::size_t Nodes>
void check_nodes(std::vector<std::array<Index, Nodes>> const& connectivity, Index nodes) {
  auto const is_wrong = [nodes](Index node) {
    return static_cast<unsigned>(node) >= static_cast<unsigned>(nodes);
  };
  HostParts(static_cast<Index>(connectivity.size()),
            few_elements(Nodes))([&](Index first, Index last, int) {
    unsigned any = 0;  // without a branch for each node
    for (Index e = first; e < last; ++e)
      for (Index node : connectivity[static_cast<std::size_t>(e)]) any |= is_wrong(node);
    for (Index e = first; any != 0 && e < last; ++e)
      for (Index node : connectivity[static_cast<std::size_t>(e)])
        if (is_wrong(node))
          throw Error("element ", e, " has node ", node, ", but nodes are numbered from 0 to ",
                      nodes - 1, "; mend the mesh");
  });
}

}  // namespace pliant::detail
