#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/constraint/rows_on.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/hanging_passes.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

/// Finds the nodes that hang in a tree in a backend's memory, all leaves of which are of one degree, as HangingNodes does on the
/// host.
template <int Dim, Backend B>
class HangingNodesOn {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  explicit HangingNodesOn(B const& backend) : backend_(backend) {}

  /// Every one, ascending by the user's numbers, with its free masters; by row_of_node(the user's number), in the backend's
  /// memory. Throws Error for a tree that mixes degrees.
  RowsOn<B> rows(TreeOn<B> const& tree, Index const* row_of_node) {
    if (tree.mixes_degrees())
      throw Error("hanging nodes: the tree mixes degrees; take HangingNodes, on the host");
    auto const sizes = tree.sizes();
    forget();
    detail::HangingView<Dim> const view{tree.view()};
    need(edges_, sizes.edges);
    need(sides_, sizes.sides);
    need(counters_, 2);
    backend_.select(sizes.edges, detail::IsHungOnEdge<Dim>{view}, edges_.data(), counters_.data());
    backend_.select(sizes.sides, detail::IsHungOnSide<Dim>{view}, sides_.data(),
                    counters_.data() + 1);
    auto const counts = counted<2>();
    Index const places = counts[0] + counts[1];
    detail::HungOn<Dim> const hung{view, edges_.data(), sides_.data(), counts[0]};
    need(start_, places + 1);
    backend_.scan(places, hung, start_.data());
    Index const n = entry(start_, places);
    if (n == 0) return {};
    need(nodes_, n);
    need(order_, n);
    need(places_, n);
    if (slave_at_.size() < at(sizes.nodes))
      slave_at_ = zeros<Index>(backend_, at(sizes.nodes) + at(sizes.nodes) / 2);
    backend_.for_each(places, detail::ListSlaves<Dim>{hung, start_.data(), nodes_.data(),
                                                      order_.data(), places_.data()});
    backend_.sort(n, nodes_.data(), order_.data(), detail::key_bits(sizes.nodes));
    backend_.for_each(n, detail::NumberSlaves{nodes_.data(), slave_at_.data(), true});
    known_ = n;

    detail::FreeMasters<Dim> const masters{hung, order_.data(), places_.data(), slave_at_.data()};
    RowsOn<B> rows;
    rows.count = n;
    rows.node = zeros<Index>(backend_, at(n));
    rows.first = zeros<Index>(backend_, at(n) + 1);
    counters_ = zeros<Index>(backend_, 2);
    backend_.scan(n, detail::CountMasters<Dim>{masters, counters_.data() + 1}, rows.first.data());
    backend_.for_each(1, detail::CopyValue<Index>{rows.first.data() + n, counters_.data()});
    auto const [entries, too_many] = counted<2>();
    if (too_many != 0)
      throw Error("hanging nodes: one has more than ", detail::MasterList::most,
                  " masters; keep neighbours of finer elements within one level");
    rows.other = zeros<Index>(backend_, at(entries));
    rows.weight = zeros<T>(backend_, at(entries));
    backend_.for_each(
        n, detail::FillSlaves<Dim, T>{masters, nodes_.data(), row_of_node, rows.first.data(),
                                      rows.node.data(), rows.other.data(), rows.weight.data()});
    return rows;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  void need(auto& array, Index count) { detail::grow(backend_, array, at(count)); }
  template <std::size_t N>
  std::array<Index, N> counted() {
    std::array<Index, N> counts;
    counters_.download(counts);
    return counts;
  }
  Index entry(Array<Index> const& numbers, Index i) {
    backend_.for_each(1, detail::CopyValue<Index>{numbers.data() + i, counters_.data()});
    return counted<1>()[0];
  }
  /// No node is a slave.
  void forget() {
    backend_.for_each(known_, detail::NumberSlaves{nodes_.data(), slave_at_.data(), false});
    known_ = 0;
  }

  B backend_;
  Array<Index> edges_, sides_, start_, order_, counters_;
  Array<std::uint64_t> nodes_;  // slaves
  Array<detail::HangingPlace> places_;
  Array<Index> slave_at_;  // by node: its number among slaves, one more; or zero
  Index known_ = 0;        // slaves that are numbered there
};

}  // namespace pliant
