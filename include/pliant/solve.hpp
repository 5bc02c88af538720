#pragma once

// The solvers of systems of equations, with sparse matrices, for which Eigen is enough, or without: static equilibrium,
// implicit dynamics, and the matrices by themselves. Not part of pliant.hpp, for the sake of those that step explicitly.
#include <pliant/solver/assemble.hpp>
#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/equilibrium_path.hpp>
#include <pliant/solver/implicit.hpp>
#include <pliant/solver/newton.hpp>
#include <pliant/solver/static_reactions.hpp>
