#pragma once

#include <pliant/element/linear.hpp>
#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/topology/refinement_pattern.hpp>

namespace pliant {

/// The elements that can be refined: of the catalogue's shape functions.
template <class E>
concept Refinable = Element<E> && has_pattern<typename E::cell> &&
                    (std::derived_from<E, LinearElement<typename E::cell>> || CurvedSimplex<E> ||
                     (TensorCell<typename E::cell> && E::degree == 2));

}  // namespace pliant
