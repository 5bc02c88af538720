#pragma once

#include <string>

#include <pliant/mesh/mesh.hpp>

namespace pliant::detail {

/// An element of a mesh in words: its type, number and nodes.
template <Element E, class M>
std::string describe(M const& mesh, std::size_t e) {
  std::string text = message({E::name(), " element ", e, " with nodes"});
  for (Index node : mesh.template elements<E>()[e]) text += message({" ", node});
  return text;
}

}  // namespace pliant::detail
