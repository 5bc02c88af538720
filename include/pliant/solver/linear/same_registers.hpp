#pragma once

#include <atomic>
#include <bit>

#include <Eigen/Core>

#include <pliant/error.hpp>

// Eigen aligns what it allocates by the registers that a source is compiled for. Where those of one program differ, functions
// of one kind of source free what those of another allocated otherwise.
namespace pliant::detail {

/// By how many bytes Eigen aligns in the sources of this program: a bit for each.
inline std::atomic<unsigned> eigen_alignments{0};

struct NoteEigenAlignment {
  explicit NoteEigenAlignment(unsigned bytes) { eigen_alignments |= bytes; }
};
namespace {
// Of each source by itself.
[[maybe_unused]] NoteEigenAlignment const note_eigen_alignment{EIGEN_MAX_ALIGN_BYTES};
}  // namespace

/// Throws Error where sources of this program that solve systems of equations are compiled for registers of several widths.
inline void check_registers(unsigned alignments = eigen_alignments) {
  if (std::popcount(alignments) > 1)
    throw Error(
        "solvers: sources of this program are compiled for registers of different widths, which "
        "Eigen's matrices cannot go between; give all of them the same -march, those that nvcc "
        "compiles by -Xcompiler=-march=...");
}

}  // namespace pliant::detail
