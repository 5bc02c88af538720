#pragma once

#include <string>

#include <pliant/formulation/formulation.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant::verification {

/// The quadrature that REFERENCES calls full: as many points as an affine element of linear elasticity
/// needs.
template <Element E>
using Full = Gauss<SimplexCell<typename E::cell> ? E::degree : E::degree + 1>;

/// "Quad9, Gauss<3>, NeoHookean"
template <class F>
std::string name_of() {
  std::string name = __PRETTY_FUNCTION__;
  auto const begin = name.find("Formulation<") + 12;
  name = name.substr(begin, name.find(">;", begin) - begin);
  for (std::string const part : {"pliant::verification::", "pliant::", "::law"})
    for (auto at = name.find(part); at != std::string::npos; at = name.find(part))
      name.erase(at, part.size());
  return name;
}

}  // namespace pliant::verification
