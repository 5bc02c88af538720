#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/adaptation/lists_on.hpp>
#include <pliant/body/criteria_workspace.hpp>

// Which elements of a type were one before, in the backend's memory: where the mesh is changed there, the host is not asked.
namespace pliant::detail {

/// What the refinement tree says of an element.
struct ElementInTree {
  Index parent = -1;          // cell; −1: none
  std::uint8_t children = 0;  // of the parent
  std::uint8_t level = 0;

  ElementInTree() = default;
  PLIANT_HOST_DEVICE ElementInTree(TreeView const& tree, Index cell) {
    auto const& own = tree.cells[static_cast<std::size_t>(cell)];
    parent = own.parent;
    level = static_cast<std::uint8_t>(own.level);
    if (parent >= 0)
      children = static_cast<std::uint8_t>(
          tree.cells[static_cast<std::size_t>(parent)].divided().children);
  }
};
/// By the user's number, of elements by their internal ones.
struct LookUpInTree {
  TreeView tree;
  Index const *leaves, *number;
  ElementInTree* found;
  PLIANT_HOST_DEVICE void operator()(Index i) const { found[number[i]] = {tree, leaves[i]}; }
};
/// Children of a cell stand beside each other by the user's numbers: these ascend with cells.
struct FindSiblings {
  ElementInTree const* in_tree;
  Index elements;
  Siblings* siblings;

  PLIANT_HOST_DEVICE void operator()(Index e) const {
    auto const& own = in_tree[e];
    Siblings found(-1, own.children, own.level);
    if (own.parent >= 0) {
      Index first = e, end = e + 1;
      while (first > 0 && in_tree[first - 1].parent == own.parent) --first;
      while (end < elements && in_tree[end].parent == own.parent) ++end;
      if (end - first == Index{own.children}) found.first = first;
    }
    siblings[e] = found;
  }
};

/// `number`: the user's, of each element, in the backend's memory.
template <class Parts, class Table>
auto siblings_on_backend(Parts const& parts, Table const& table, Index const* number) {
  auto const& backend = parts.backend;
  auto const count = static_cast<std::size_t>(table.count());
  auto const look_up = [&] {
    if constexpr (changes_on_backend<Parts>)
      if (auto const& on = parts.topology_on) {
        auto found = unset<ElementInTree>(backend, count);
        backend.for_each(table.count(),
                         LookUpInTree{on->tree.view(), on->leaves(type_of<Parts, Table>).leaves,
                                      number, found.data()});
        return found;
      }
    std::vector<ElementInTree> found(count);
    if (auto const& topology = *parts.state.topology; topology.tree) {
      auto const view = topology.tree->tree().lists().view();
      std::size_t e = 0;
      for (Index cell : topology.cells[type_of<Parts, Table>]) found[e++] = {view, cell};
    }
    return upload(backend, found);
  };
  auto const in_tree = look_up();
  auto siblings = unset<Siblings>(backend, count);
  backend.for_each(table.count(), FindSiblings{in_tree.data(), table.count(), siblings.data()});
  return siblings;
}

}  // namespace pliant::detail
