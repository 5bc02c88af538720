#pragma once

#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant {

/// A change of topology as Body::on_change tells it: what there was, what there is, and how values go over.
template <class M>
struct TopologyChange {
  Topology<M> const& before;
  Topology<M> const& after;
  Transfer<M::dim> const& transfer;
};

}  // namespace pliant
