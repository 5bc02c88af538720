#pragma once

#include <string>

#include <pliant/reference.hpp>

namespace pliant::test {

/// The serial backend with patches of `Size` elements, where those of 512 would hold all of a small mesh.
template <std::floating_point T, Index Size>
class SmallPatches : public Reference<T> {
 public:
  static char const* name() {
    static std::string const own = "Reference, patches of " + std::to_string(Size);
    return own.c_str();
  }
  template <int Nodes>
  class Elements : public Reference<T>::template Elements<Nodes> {
    using Base = typename Reference<T>::template Elements<Nodes>;

   public:
    Elements() = default;
    Elements(SmallPatches const& backend, std::vector<std::array<Index, Nodes>> connectivity,
             int groups, std::vector<Tag> const& tags, Index nodes,
             NodeOrder order = NodeOrder::as_given)
        : Base(backend, std::move(connectivity), groups, tags, nodes, order, Size) {}
  };
};

}  // namespace pliant::test
