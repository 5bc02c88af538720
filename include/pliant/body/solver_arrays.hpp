#pragma once

#include <array>
#include <memory>
#include <optional>

#include <pliant/backend/backend.hpp>

namespace pliant {

namespace detail {
/// What a solver keeps of preconditioning a body's matrices, and of a method for them.
struct KeptBySolver {
  virtual ~KeptBySolver() = default;
};
}  // namespace detail

/// What solvers on a backend work in, kept from call to call: fields of padded rows, (nodes, 4). It holds nothing
/// that a run goes on with.
template <Backend B>
struct SolverArrays {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;

  Array<T> increment;                         // u' − u, m
  Array<T> trial;                             // a change of it that is tried, m
  Array<T> place, speed, acceleration;        // where balance is asked for: m, m/s, m/s²
  Array<T> force, inert, residual;            // N; the first two with scratch rows
  Array<T> solution, direction, conditioned;  // of Krylov methods
  Array<T> right_side;                        // of the system that they solve
  Array<T> image;                             // of the direction, with scratch rows
  Array<T> blocks;                            // (dim, nodes, 4): inverse blocks of nodes
  Array<double> scalars;                      // of Krylov methods

  /// Iterations of a Krylov method, and the matrix of which they are.
  struct Recorded {
    typename B::Recording recording;
    long revision;
    std::array<double, 4> matrix;
    std::array<T const*, 2> fields;
    detail::KeptBySolver const* preconditioner;
    detail::KeptBySolver const* method;
  };
  std::optional<Recorded> recorded{};
  std::unique_ptr<detail::KeptBySolver> preconditioner{}, minres{};  // made when first asked for

  SolverArrays(B const& backend, std::size_t rows, std::size_t rows_and_scratch, int dim) {
    for (auto* array : {&increment, &trial, &place, &speed, &acceleration, &residual, &solution,
                        &direction, &conditioned, &right_side})
      *array = zeros<T>(backend, rows);
    for (auto* array : {&force, &inert, &image}) *array = zeros<T>(backend, rows_and_scratch);
    blocks = zeros<T>(backend, static_cast<std::size_t>(dim) * rows);
    scalars = zeros<double>(backend, 16);
  }
};

}  // namespace pliant
