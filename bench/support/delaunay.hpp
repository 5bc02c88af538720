#pragma once

#include <cstdint>
#include <fstream>

#include <pliant/pliant.hpp>

namespace pliant::bench {

template <class U>
std::vector<U> read_values(std::istream& file, std::size_t count) {
  std::vector<U> values(count);
  file.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(count * sizeof(U)));
  return values;
}

/// The tetrahedra that bench/delaunay wrote. Throws Error where the file is not one of its own.
inline Mesh<Tet4> read_delaunay(std::string const& name) {
  std::ifstream file(name, std::ios::binary);
  auto const counts = read_values<std::int32_t>(file, 2);
  if (!file || counts[0] < 4 || counts[1] < 1)
    throw Error(name, ": no mesh; make it by bench/delaunay");
  auto const nodes = static_cast<std::size_t>(counts[0]);
  auto const elements = static_cast<std::size_t>(counts[1]);
  auto const places = read_values<float>(file, 3 * nodes);
  auto const numbers = read_values<std::int32_t>(file, 4 * elements);
  if (!file) throw Error(name, ": the mesh is cut off; make it anew by bench/delaunay");
  Mesh<Tet4> mesh;
  for (std::size_t i = 0; i < places.size(); i += 3)
    mesh.nodes.push_back({places[i], places[i + 1], places[i + 2]});
  for (std::size_t i = 0; i < numbers.size(); i += 4)
    mesh.elements<Tet4>().push_back({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]});
  check(mesh);
  return mesh;
}

}  // namespace pliant::bench
