#pragma once

#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// A change of topology, as listeners of Body::on_change get it: the mesh before it, the mesh after it, and how
/// values go over. Valid during the call.
template <class M>
struct TopologyChange {
  Topology<M> const& before;
  Topology<M> const& after;
  Transfer<M::dim> const& transfer;
};

}  // namespace pliant
