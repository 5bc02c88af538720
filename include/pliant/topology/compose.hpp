#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/constraint/slave_rows.hpp>
#include <pliant/error.hpp>

namespace pliant {

namespace detail {

/// The places of slaves in a list, by their nodes: a table of all nodes where slaves are many, else a sorted list.
class SlavePlaces {
 public:
  static constexpr Index none = -1;

  /// Throws Error for a slave of no node, and for a node that is a slave twice.
  explicit SlavePlaces(std::span<Index const> slaves) {
    Index largest = -1;
    for (Index const node : slaves) {
      if (node < 0) throw Error("compose: there is no node ", node);
      largest = std::max(largest, node);
    }
    bool const many = static_cast<std::size_t>(largest) / 64 < slaves.size();
    if (many) table_.assign(static_cast<std::size_t>(largest) + 1, none);
    for (Index i = 0; Index const node : slaves) {
      if (!many) {
        sorted_.emplace_back(node, i++);
      } else if (std::exchange(table_[static_cast<std::size_t>(node)], i++) != none) {
        refuse(node);
      }
    }
    std::ranges::sort(sorted_);
    auto const twice = std::ranges::adjacent_find(sorted_, {}, &std::pair<Index, Index>::first);
    if (twice != sorted_.end()) refuse(twice->first);
  }
  /// `none` for a node that is no slave.
  [[nodiscard]] Index of(Index node) const {
    if (!table_.empty())
      return static_cast<std::size_t>(node) < table_.size() ? table_[static_cast<std::size_t>(node)]
                                                            : none;
    auto const found = std::ranges::lower_bound(sorted_, node, {}, &std::pair<Index, Index>::first);
    return found != sorted_.end() && found->first == node ? found->second : none;
  }
  /// visit(place), by ascending nodes.
  template <class Visit>
  void for_each(Visit const& visit) const {
    for (Index const place : table_)
      if (place != none) visit(place);
    for (auto const& [node, place] : sorted_) visit(place);
  }

 private:
  [[noreturn]] static void refuse(Index node) {
    throw Error("compose: node ", node,
                " is a slave twice; list each slave once, with all of its masters");
  }
  std::vector<Index> table_;
  std::vector<std::pair<Index, Index>> sorted_;
};

}  // namespace detail

/// Replaces masters that are slaves themselves by their own masters, until every master is free;
/// a master reached along several ways appears once, with the sum of the weights. The result ascends by node.
/// A slave must come after the slaves among its masters. Throws Error where one does not (which is
/// so for any circle of slaves) and where a node is a slave twice.
[[nodiscard]] inline SlaveRows compose_rows(SlaveRows const& slaves) {
  detail::SlavePlaces const places(slaves.nodes());
  constexpr Index few = 4096;  // slaves that are worth a thread
  auto const count = static_cast<Index>(slaves.size());
  std::vector<char> is_composed(slaves.size());  // not to be looked at again
  detail::for_each_on_host(count, few, [&](Index k) {
    auto const i = static_cast<std::size_t>(k);
    auto const masters = slaves[i].masters;
    auto const is_free = [&](NodeWeight const& own) {
      return places.of(own.first) == detail::SlavePlaces::none;
    };
    is_composed[i] =
        std::ranges::is_sorted(masters, std::ranges::less_equal{}, &NodeWeight::first) &&
        std::ranges::all_of(masters, is_free);
  });
  SlaveRows others;  // those that were not
  std::vector<std::size_t> place_among_others(slaves.size());
  auto const row = [&](std::size_t i) {
    return is_composed[i] ? slaves[i] : others[place_among_others[i]];
  };
  std::vector<NodeWeight> composed, summed;
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    if (is_composed[i]) continue;
    // Ascending, equal ones in the order in which they come, so that they are summed in a fixed order.
    composed.clear();
    auto const add = [&](Index master, double weight) {
      composed.insert(std::ranges::upper_bound(composed, master, {}, &NodeWeight::first),
                      {master, weight});
    };
    for (auto const& [master, weight] : slaves[i].masters) {
      Index const found = places.of(master);
      if (found == detail::SlavePlaces::none) {
        add(master, weight);
        continue;
      }
      if (static_cast<std::size_t>(found) >= i)
        throw Error("compose: slave node ", slaves[i].node, " has the master ", master,
                    ", a slave that does not come before it; order slaves after their masters");
      for (auto const& [free, share] : row(static_cast<std::size_t>(found)).masters)
        add(free, weight * share);
    }
    summed.clear();
    for (auto const& [free, weight] : composed) {
      if (!summed.empty() && summed.back().first == free)
        summed.back().second += weight;
      else
        summed.emplace_back(free, weight);
    }
    place_among_others[i] = others.size();
    others.push_back(slaves[i].node, summed);
  }
  std::vector<std::size_t> order, sizes;  // ascending by node, as an Interpolation wants them
  order.reserve(slaves.size());
  sizes.reserve(slaves.size());
  places.for_each([&](Index place) {
    order.push_back(static_cast<std::size_t>(place));
    sizes.push_back(row(order.back()).masters.size());
  });
  SlaveRows ascending(sizes);
  detail::for_each_on_host(count, few, [&](Index k) {
    auto const i = static_cast<std::size_t>(k);
    ascending.set(i, row(order[i]));
  });
  return ascending;
}
/// The same of a list of slaves.
[[nodiscard]] inline std::vector<Slave> compose(std::vector<Slave> const& slaves) {
  return detail::slaves_of(compose_rows(detail::rows_of(slaves)));
}

}  // namespace pliant
