// What PLIANT_COMPILED_SOLVERS leaves out of the headers: see pliant/solver/linear/compiled_once.hpp.
#include <pliant/solver/linear/definitions/dense_inverse.hpp>
#include <pliant/solver/linear/definitions/direct_solver.hpp>
#include <pliant/solver/linear/definitions/lanczos_matrix.hpp>
#include <pliant/solver/linear/definitions/linear_solver.hpp>
#include <pliant/solver/linear/definitions/multilevel.hpp>
#include <pliant/solver/linear/definitions/positive_part.hpp>

template class pliant::detail::Multilevel<2>;
template class pliant::detail::Multilevel<3>;
template class pliant::detail::LinearSolver<2>;
template class pliant::detail::LinearSolver<3>;
