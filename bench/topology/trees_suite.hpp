#pragma once

#include <array>
#include <memory>

#include <pliant/body/node_rows_on.hpp>
#include <pliant/topology/hanging_nodes_on.hpp>

#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// The refinement tree of a mesh in a backend's memory, and on the host: passes of a refinement, without a body. The rate
// counts the elements that are refined.
namespace pliant::bench {

/// A tree of a cube of which nothing is divided, here and there.
template <Element E, class B>
struct Trees {
  Mesh<E> mesh;
  Numbering<E> numbering;
  CellOrder first;
  Hierarchy<E::dim> host;
  TreeOn<B> here;
  HangingNodesOn<E::dim, B> hanging;
  double bytes_per_cell;  // of a tree that was not changed yet

  Trees(B const& backend, int cells)
      : mesh(mesh_of<E>(cells)),
        numbering(mesh),
        first(first_order(numbering)),
        host(mesh),
        here(backend, host.tree().lists(), *host.tree().cells_at_edges()),
        hanging(backend),
        bytes_per_cell(static_cast<double>(here.bytes()) /
                       static_cast<double>(here.sizes().cells)) {}
};

enum class TreePass { here, host, order, rows, hanging, coarsen, coarsen_host };

/// The first cell, and others at a distance from each other.
inline std::vector<Index> cells_at_distances(Index distance, std::size_t count) {
  std::vector<Index> marked;
  for (std::size_t k = 0; k < count; ++k) marked.push_back(static_cast<Index>(k) * distance);
  return marked;
}

/// Those that a refinement of a tree made, where there are so many in all now.
template <int Dim>
std::vector<Index> cells_from(Hierarchy<Dim> const& before, Index cells) {
  std::vector<Index> made;
  for (auto c = static_cast<Index>(before.cells().size()); c < cells; ++c) made.push_back(c);
  return made;
}

template <Element E, class B>
void time_tree(benchmark::State& state, B const& backend, int cells, TreePass pass,
               std::vector<Index> const& marked) {
  HostThreads const threads(backend);
  auto const trees = made_once([&] { return std::make_shared<Trees<E, B>>(backend, cells); });
  auto const list = upload(backend, marked);
  auto const count = static_cast<Index>(marked.size());
  for (auto _ : state) {
    if (pass == TreePass::host || pass == TreePass::coarsen_host) {
      auto copy = trees->host;
      double const there = seconds(backend, [&] { copy.refine(marked); });
      auto const made = cells_from(trees->host, static_cast<Index>(copy.cells().size()));
      double const back = seconds(backend, [&] { copy.coarsen(made); });
      state.SetIterationTime(pass == TreePass::host ? there : back);
      continue;
    }
    auto& tree = trees->here;
    LeafOrderOn<B> order(backend, trees->first);
    NodeRowsOn<B> rows(backend, {trees->numbering.internal_node, trees->numbering.user_node, {}});
    std::array<double, 7> times{};
    auto const time = [&](TreePass which, auto const& work) {
      times[static_cast<std::size_t>(which)] = seconds(backend, work);
    };
    typename TreeOn<B>::Refined refined;
    time(TreePass::here, [&] { refined = tree.refine(list.data(), count); });
    time(TreePass::order, [&] { order.refine(tree, refined); });
    time(TreePass::rows, [&] { rows.refine(tree, order, refined); });
    time(TreePass::hanging, [&] { trees->hanging.rows(tree, rows.of_node()); });
    auto const made = upload(backend, cells_from(trees->host, tree.sizes().cells));
    time(TreePass::coarsen, [&] { tree.coarsen(made.data(), static_cast<Index>(made.size())); });
    state.SetIterationTime(times[static_cast<std::size_t>(pass)]);
    tree.take_back();
  }
  report_rate(state, "items_per_second", static_cast<double>(count));
  state.counters["bytes_per_cell"] = trees->bytes_per_cell;
}

inline void add_trees() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role != Role::main) return;
    auto const one = [&]<class E>(E, double elements) {
      int const cells = cells_for<E>(elements);
      auto const total = static_cast<std::size_t>(element_count<E>(cells));
      auto const change = [&](std::string const& what, std::vector<Index> const& marked) {
        auto const pass = [&](std::string const& of, TreePass which) {
          add<Usual<E, SaintVenantKirchhoff>, double>(
              of + " " + what, name, cells,
              [=](benchmark::State& state) { time_tree<E>(state, backend, cells, which, marked); });
        };
        pass("tree", TreePass::here);
        pass("tree on the host", TreePass::host);
        pass("order", TreePass::order);
        pass("rows", TreePass::rows);
        pass("hanging nodes", TreePass::hanging);
        pass("coarsen tree", TreePass::coarsen);
        pass("coarsen tree on the host", TreePass::coarsen_host);
      };
      change("of two", cells_at_distances(1, 2));
      change("of a ten thousandth", cells_at_distances(9973, total / 10000));
      change("of a hundredth", cells_at_distances(1, total / 100));
      change("of each hundredth", cells_at_distances(100, total / 100));
      change("of a tenth", cells_at_distances(1, total / 10));
      change("of each tenth", cells_at_distances(10, total / 10));
    };
    one(Tet4{}, 1e6);
    one(Hex8{}, 1e5);
  });
}

}  // namespace pliant::bench
