#pragma once

#include <map>
#include <set>

#include <pliant/body/sleep.hpp>

#include "support/at.hpp"
#include "support/formulations.hpp"
#include "support/keeps_trees.hpp"
#include "support/small_patches.hpp"

// Which nodes belong to which patches, beside what sets and maps say.
namespace pliant::test::patch_nodes_suite {

using Tri = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
using Quad = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

using Rows = std::vector<std::vector<Index>>;

/// From compressed rows.
inline Rows rows_of(std::vector<Index> const& first, std::vector<Index> const& entries) {
  Rows rows;
  for (std::size_t r = 0; r + 1 < first.size(); ++r)
    rows.emplace_back(entries.begin() + first[r], entries.begin() + first[r + 1]);
  return rows;
}

/// The nodes of pieces of a patch: of elements that share a node, or share it with others.
inline std::vector<std::set<Index>> pieces_of(std::vector<std::set<Index>> const& elements) {
  std::vector<std::set<Index>> pieces;
  for (auto joined : elements) {
    std::erase_if(pieces, [&](std::set<Index> const& piece) {
      bool const meet =
          std::ranges::any_of(piece, [&](Index node) { return joined.contains(node); });
      if (meet) joined.insert(piece.begin(), piece.end());
      return meet;
    });
    pieces.push_back(joined);
  }
  std::ranges::sort(pieces, {}, [](std::set<Index> const& piece) { return *piece.begin(); });
  return pieces;
}

/// Of each patch, the nodes of its elements, and the masters of these.
template <class Parts>
std::vector<std::vector<std::set<Index>>> elements_of_patches(Parts const& parts,
                                                              bool with_masters) {
  using B = typename Parts::backend_type;
  std::map<Index, std::vector<Index>> masters;
  auto const& slaves = parts.layout.interpolation.slaves();
  if (with_masters && slaves.count > 0) {
    auto const node = download<Index>(slaves.node), first = download<Index>(slaves.first),
               other = download<Index>(slaves.other);
    for (std::size_t k = 0; k < at(slaves.count); ++k)
      masters[node[k]] = {other.begin() + first[k], other.begin() + first[k + 1]};
  }
  std::vector<std::vector<std::set<Index>>> found;
  parts.for_each_type([&](auto const& table, auto const&) {
    auto const rows = table.elements.rows_of_nodes();
    auto copy = zeros<Index>(parts.backend, at(rows.width) * at(table.count()));
    detail::copy_values<B, Index>(parts.backend, rows.nodes, copy.data(), copy.size());
    auto const nodes = download<Index>(copy);
    auto const bounds = table.elements.patch_bounds();
    for (std::size_t p = 0; p < at(table.elements.patch_count()); ++p) {
      auto& elements = found.emplace_back();
      for (Index e = bounds[p]; e < bounds[p + 1]; ++e) {
        auto& own = elements.emplace_back();
        for (int a = 0; a < std::remove_cvref_t<decltype(table)>::element::nodes; ++a) {
          Index const node = nodes[at(e * rows.width + a)];
          own.insert(node);
          for (Index const master : masters[node]) own.insert(master);
        }
      }
    }
  });
  return found;
}

/// How many nodes patches have, each counted for itself.
inline std::size_t members(std::vector<std::vector<std::set<Index>>> const& patches) {
  std::size_t count = 0;
  for (auto const& elements : patches) {
    std::set<Index> nodes;
    for (auto const& own : elements) nodes.insert(own.begin(), own.end());
    count += nodes.size();
  }
  return count;
}

struct Found {
  std::size_t nodes_in_several = 0, other_pieces = 0, by_masters = 0;
};

template <class TheBody>
Found check_patches(TheBody& body) {
  auto& parts = body.parts();
  auto const made = detail::make_patch_nodes(parts);

  auto const elements = elements_of_patches(std::as_const(parts), true);
  auto const patches = static_cast<Index>(elements.size());
  std::vector<Index> patch, first_other;
  std::vector<std::map<Index, Index>> piece_of_node(at(parts.layout.rows));  // by the patch
  for (Index p = 0; p < patches; ++p) patch.push_back(p);
  for (Index p = 0; p < patches; ++p) {
    first_other.push_back(static_cast<Index>(patch.size()));
    auto const pieces = pieces_of(elements[at(p)]);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      Index const piece = k == 0 ? p : static_cast<Index>(patch.size());
      if (k > 0) patch.push_back(p);
      for (Index const node : pieces[k]) piece_of_node[at(node)][p] = piece;
    }
  }
  first_other.push_back(static_cast<Index>(patch.size()));
  Rows of_nodes;
  std::vector<std::set<Index>> beside(patch.size());
  Found found{
      .other_pieces = patch.size() - elements.size(),
      .by_masters = members(elements) - members(elements_of_patches(std::as_const(parts), false))};
  for (auto const& own : piece_of_node) {
    auto& row = of_nodes.emplace_back();
    for (auto const& [of_patch, piece] : own) row.push_back(piece);
    found.nodes_in_several += row.size() > 1;
    for (Index const a : row)
      for (Index const b : row)
        if (a != b) beside[at(a)].insert(b);
  }
  Rows neighbours;
  for (auto const& own : beside) neighbours.emplace_back(own.begin(), own.end());

  CHECK(made.count() == patches);
  CHECK(made.pieces_count() == static_cast<Index>(patch.size()));
  CHECK(download<Index>(made.patch) == patch);
  CHECK(download<Index>(made.first_other) == first_other);
  CHECK(rows_of(download<Index>(made.first), download<Index>(made.pieces)) == of_nodes);
  CHECK(rows_of(download<Index>(made.first_beside), download<Index>(made.beside)) == neighbours);
  return found;
}

TEST_CASE("patches have the nodes of their elements", "[body]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    Body body{backend, mixed_mesh(40), soft, Group<Tri>{}, Group<Quad>{}};
    CHECK(check_patches(body).nodes_in_several > 0);
  });
}

TEST_CASE("patches have the masters of their hanging nodes too", "[body]") {
  on_each_backend<KeepingBackends>([](auto const& backend) {
    for (bool const on_host : {false, true}) {
      Body body{backend, mesh::rectangle<Tri3>({.size = {20, 0.3}, .cells = {400, 6}}), soft,
                Group<Tri>{}};
      if (on_host) change_on_host(body);
      std::vector<Index> marked;
      for (Index e = 0; e < 4800; e += 3) marked.push_back(e);
      refine(body, {marked});
      CHECK(check_patches(body).by_masters > 0);
    }
  });
}

/// Long bars one above the other, apart from each other.
inline Mesh<Tri3> bars(int count, int length) {
  Mesh<Tri3> mesh;
  for (int bar = 0; bar < count; ++bar) {
    auto const one = mesh::rectangle<Tri3>(
        {.size = {1.0 * length, 1}, .cells = {length, 1}, .origin = {0, 1.5 * bar}});
    auto const first = static_cast<Index>(mesh.nodes.size());
    mesh.nodes.insert(mesh.nodes.end(), one.nodes.begin(), one.nodes.end());
    for (auto element : one.elements<Tri3>()) {
      for (Index& node : element) node += first;
      mesh.elements<Tri3>().push_back(element);
    }
  }
  return mesh;
}

TEST_CASE("a patch falls into the pieces that share no node", "[body]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    Body body{backend, bars(60, 40), soft, Group<Tri>{}};
    CHECK(check_patches(body).other_pieces > 0);
  });
}
TEST_CASE("pieces of small patches", "[body]") {
  Body body{SmallPatches<double, 3>{}, bars(4, 10), soft, Group<Tri>{}};
  auto const found = check_patches(body);
  CHECK(found.other_pieces > 0);
  CHECK(found.nodes_in_several > 0);
}

TEST_CASE("a long patch is one piece", "[body]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    Body body{backend, bars(1, 1200), soft, Group<Tri>{}};
    CHECK(check_patches(body).other_pieces == 0);
  });
}

}  // namespace pliant::test::patch_nodes_suite
