#pragma once

#include <vector>

#include <pliant/solver/linear/block_matrix.hpp>
#include <pliant/solver/linear/lanczos_matrix.hpp>

namespace pliant::detail {

/// The inverses of a matrix's diagonal blocks.
template <int N>
class BlockJacobi {
 public:
  BlockJacobi() = default;
  explicit BlockJacobi(HostTasks const& tasks, BlockMatrix<N, N> const& a)
      : inverse_(static_cast<std::size_t>(a.rows()) * N * N) {
    tasks.in_parts(a.rows(), 256, [&](Index from, Index to) {
      for (Index row = from; row < to; ++row)
        Block::Map(at(row)) = Block::Map(a.at(a.find(row, row))).inverse();
    });
  }
  /// D⁻¹ of a row times a block with C columns.
  template <int C>
  void add_product_of(Index row, double const* block, double* to) const {
    add_product<N, N, C>(to, at(row), block);
  }

 private:
  using Block = Eigen::Matrix<double, N, N, Eigen::RowMajor>;
  double* at(Index row) { return inverse_.data() + static_cast<std::size_t>(row) * N * N; }
  double const* at(Index row) const {
    return inverse_.data() + static_cast<std::size_t>(row) * N * N;
  }
  std::vector<double> inverse_;
};

/// The largest eigenvalue of D⁻¹ A, from below and closely: see LanczosMatrix.
template <int N>
double largest_eigenvalue(HostTasks const& tasks, BlockMatrix<N, N> const& a,
                          BlockJacobi<N> const& jacobi, int steps = 12) {
  auto const n = Eigen::Index{N} * a.rows();
  Eigen::VectorXd r(n), z(n), p, q;
  std::uint32_t seed = 1;
  for (double& x : r) {
    seed = 1664525 * seed + 1013904223;
    x = static_cast<double>(seed >> 8) / (1 << 24) - 0.5;
  }
  LanczosMatrix lanczos;
  double rz = 0;
  for (int step = 0; step < steps; ++step) {
    z.setZero();
    for (Index row = 0; row < a.rows(); ++row)
      jacobi.template add_product_of<1>(row, r.data() + Eigen::Index{N} * row,
                                        z.data() + Eigen::Index{N} * row);
    double const before = std::exchange(rz, r.dot(z));
    if (!(rz > 0)) break;
    double const beta = step == 0 ? 0 : rz / before;
    p = step == 0 ? z : Eigen::VectorXd(z + beta * p);
    multiply(tasks, a, p, q);
    double const alpha = rz / p.dot(q);
    if (!lanczos.add(alpha, beta)) break;
    r -= alpha * q;
  }
  return lanczos.largest();
}

/// Steps towards A x = b that make errors of large eigenvalues small: Chebyshev's polynomial of D⁻¹ A over
/// [largest/10, 1.1 largest] (Adams, Brezina, Hu, Tuminaro, Parallel multigrid smoothing, 2003).
template <int N>
class Chebyshev {
 public:
  Chebyshev() = default;
  Chebyshev(HostTasks const& tasks, BlockMatrix<N, N> const& a)
      : jacobi_(tasks, a), largest_(largest_eigenvalue(tasks, a, jacobi_)) {}

  double largest() const { return largest_; }
  BlockJacobi<N> const& jacobi() const { return jacobi_; }

  /// `from_zero`: x counts as 0.
  void smooth(HostTasks const& tasks, BlockMatrix<N, N> const& a, Eigen::VectorXd const& b,
              Eigen::VectorXd& x, bool from_zero, int degree = 2) {
    double const high = 1.1 * largest_, low = 0.1 * largest_;
    double const middle = (high + low) / 2, half = (high - low) / 2, sigma = middle / half;
    double rho = 1 / sigma;
    if (from_zero) x.setZero(b.size());
    step_.resize(b.size());
    for (int k = 0; k < degree; ++k) {
      double const rho_next = k == 0 ? rho : 1 / (2 * sigma - rho);
      double const keep = k == 0 ? 0 : rho_next * rho,
                   take = k == 0 ? 1 / middle : 2 * rho_next / half;
      rho = rho_next;
      if (k == 0 && from_zero)
        residual_ = b;
      else {
        multiply(tasks, a, x, residual_);
        residual_ = b - residual_;
      }
      tasks.in_parts(a.rows(), 4096, [&](Index from, Index to) {
        for (Index row = from; row < to; ++row) {
          auto const at = Eigen::Index{N} * row;
          double d[N]{};
          jacobi_.template add_product_of<1>(row, residual_.data() + at, d);
          for (int i = 0; i < N; ++i) {
            step_[at + i] = (k == 0 ? 0 : keep * step_[at + i]) + take * d[i];
            x[at + i] += step_[at + i];
          }
        }
      });
    }
  }

 private:
  BlockJacobi<N> jacobi_;
  double largest_ = 1;
  Eigen::VectorXd residual_, step_;
};

}  // namespace pliant::detail
