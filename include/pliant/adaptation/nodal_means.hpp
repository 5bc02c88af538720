#pragma once

#include <algorithm>
#include <limits>

#include <pliant/adaptation/rule_context.hpp>
#include <pliant/body/criteria_workspace.hpp>

// Means over the elements around a node, and the criteria that take them: see criterion/neighbours.hpp.
namespace pliant::detail {

/// How the means of a criterion stand in memory: their weighted sums and then the weight, four to a block.
template <class C, class F>
struct MeanBlocks {
  static constexpr int values = C::template nodal_values<F>;
  static constexpr int count = values / node_stride + 1;
  static constexpr int weight = values;  // its place
};

/// What elements of group Group add to block Block at their nodes.
template <class Laws, class C, int Group, int Block>
struct AddToMeans {
  using F = typename Laws::template formulation<Group>;
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  C criterion;

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u)
            PLIANT_INLINE { return at(GroupNumber<G>{}, law, rest, u); },
        v...);
  }

 private:
  template <int G, class L, class V>
  PLIANT_HOST_DEVICE auto at(GroupNumber<G>, L const& law, V const& rest, V const& u) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto sums = Matrix<S, F::nodes, node_stride>::zero();
    if constexpr (G == Group) {
      using T = builtin_scalar<S>;
      constexpr int values = MeanBlocks<C, F>::values;
      auto const e = state_of<F>(law, rest, u);
      auto const own = criterion.to_nodes(e);
      S size(0);
      for (int a = 0; a < F::nodes; ++a)
        for (int k = 0; k < values; ++k) size = size + abs(own(a, k));
      auto const finite = size < S(std::numeric_limits<T>::max());
      S const weight = select(finite, e.volume(), S(0));
      for (int a = 0; a < F::nodes; ++a)
        for (int k = 0; k < node_stride; ++k) {
          int const place = node_stride * Block + k;
          if (place < values)
            sums(a, k) = weight * select(finite, own(a, place), S(0));
          else if (place == values)
            sums(a, k) = weight;
        }
    }
    return sums;
  }
};

/// Makes means of the sums at a node.
template <class T, int Values>
struct DivideByWeight {
  T* sums;                // (blocks, rows, 4)
  std::ptrdiff_t stride;  // from block to block

  PLIANT_HOST_DEVICE void operator()(Index node) const {
    T const weight = at(node, Values);
    T const inverse = weight > T(0) ? T(1) / weight : T(0);
    for (int k = 0; k < Values; ++k) at(node, k) = inverse * at(node, k);
  }

 private:
  PLIANT_HOST_DEVICE T& at(Index node, int k) const {
    return sums[stride * (k / node_stride) + static_cast<std::ptrdiff_t>(node_stride) * node +
                k % node_stride];
  }
};

template <class T>
struct SetToZero {
  T* values;
  PLIANT_HOST_DEVICE void operator()(Index i) const { values[i] = T(0); }
};

/// Finds the value of a criterion for the elements of group Group.
template <class Laws, class C, int Group, class T>
struct TakeMeans {
  using F = typename Laws::template formulation<Group>;
  static constexpr bool reads_elements = Laws::reads_elements;
  static constexpr int counters = 0;
  Laws groups;
  C criterion;
  T* values;  // (elements)

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u, auto const&... blocks)
            PLIANT_INLINE { return at(GroupNumber<G>{}, law, rest, u, blocks...); },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    if constexpr (G == Group) values[e] = value[0];
  }

 private:
  template <int G, class L, class V, class... Blocks>
  PLIANT_HOST_DEVICE auto at(GroupNumber<G>, L const& law, V const& rest, V const& u,
                             Blocks const&... blocks) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto value = Vector<S, 1>::zero();
    if constexpr (G == Group) {
      Matrix<S, F::nodes, MeanBlocks<C, F>::values> means;
      int block = 0;
      (take(means, blocks, block++), ...);
      value[0] = criterion(state_of<F>(law, rest, u), means);
    }
    return value;
  }
  template <class Means, class Block>
  PLIANT_HOST_DEVICE static void take(Means& means, Block const& from, int block) {
    constexpr int values = MeanBlocks<C, F>::values;
    for (int a = 0; a < F::nodes; ++a)
      for (int k = 0; k < node_stride; ++k)
        if (node_stride * block + k < values) means(a, node_stride * block + k) = from(a, k);
  }
};

/// Finds the values of a criterion that takes means for the elements of group Group.
template <int Group, class C, class Parts, class Table>
void find_value_from_means(Parts const& parts, Table const& table, C const& criterion,
                           CriteriaWorkspace<typename Parts::backend_type>& workspace, int slot) {
  using T = typename Parts::T;
  using Laws = typename Table::Laws;
  using Blocks = MeanBlocks<C, typename Table::template formulation<Group>>;
  auto const& backend = parts.backend;
  auto const rows = parts.layout.rows + table.elements.scratch_nodes();
  auto const stride = static_cast<std::ptrdiff_t>(node_stride) * rows;
  T* const sums = workspace.means.data();
  auto const field = [&](int block) {
    return NodeField<T, node_stride>{sums + stride * block, rows};
  };
  for (int b = 0; b < Blocks::count; ++b)
    backend.for_each(static_cast<Index>(stride), SetToZero<T>{sums + stride * b});
  [&]<int... B>(std::integer_sequence<int, B...>) {
    (backend.template accumulate<Table::groups>(
         table.elements, AddToMeans<Laws, C, Group, B>{table.laws, criterion}, field(B),
         parts.rest(), parts.u()),
     ...);
    auto const& interpolation = parts.layout.interpolation;
    (interpolation.apply_transpose(backend, field(B)), ...);
    backend.for_each(parts.layout.rows, DivideByWeight<T, Blocks::values>{sums, stride});
    (interpolation.apply(backend, field(B)), ...);
    backend.template visit<Table::groups>(
        table.elements,
        TakeMeans<Laws, C, Group, T>{
            table.laws, criterion,
            workspace.found.data() + static_cast<std::ptrdiff_t>(table.count()) * slot},
        parts.no_counters, parts.rest(), parts.u(),
        NodeField<T const, node_stride>{sums + stride * B, rows}...);
  }(std::make_integer_sequence<int, Blocks::count>());
}

/// Finds the values of all criteria of rules that take means.
template <class Parts, class Table, class TheRules>
void find_values_from_means(Parts const& parts, Table const& table, TheRules const& rules,
                            CriteriaWorkspace<typename Parts::backend_type>& workspace) {
  using Places = typename TheRules::Places;
  if constexpr (Places::count > 0) {
    using Workspace = CriteriaWorkspace<typename Parts::backend_type>;
    Workspace::reserve(
        parts.backend, workspace.found,
        static_cast<std::size_t>(Places::count) * static_cast<std::size_t>(table.count()));
    auto const rows = static_cast<std::size_t>(parts.layout.rows + table.elements.scratch_nodes());
    rules.for_each_taker([&]<int Group, int Slot, class C>(GroupNumber<Group>, GroupNumber<Slot>,
                                                           C const& criterion) {
      constexpr int blocks = MeanBlocks<C, typename Table::template formulation<Group>>::count;
      Workspace::reserve(parts.backend, workspace.means,
                         static_cast<std::size_t>(node_stride * blocks) * rows);
      find_value_from_means<Group>(parts, table, criterion, workspace, Slot);
    });
  }
}

}  // namespace pliant::detail
