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
  for_each_on_host(static_cast<Index>(connectivity.size()), few_elements(Nodes), [&](Index e) {
    for (Index node : connectivity[static_cast<std::size_t>(e)])
      if (node < 0 || node >= nodes)
        throw Error("element ", e, " has node ", node, ", but nodes are numbered from 0 to ",
                    nodes - 1, "; mend the mesh");
  });
}

}  // namespace pliant::detail
