#pragma once

namespace pliant {

/// How the tangents of elements, and of force terms that have an energy, enter an assembled one.
enum class ElementTangents {
  exact,
  /// Symmetric ones with their negative eigenvalues set to zero, so that the sum is positive semidefinite: a step of Newton's
  /// method then leads down in the energy wherever it begins, but no longer converges quadratically to equilibria where
  /// tangents of elements are indefinite (Teran, Sifakis, Irving and Fedkiw, Robust quasistatic finite elements and flesh
  /// simulation, Symposium on Computer Animation 2005).
  positive_semidefinite
};

}  // namespace pliant
