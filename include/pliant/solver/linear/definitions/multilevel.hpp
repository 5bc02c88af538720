#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/SparseCholesky>

#include <pliant/solver/linear/aggregates.hpp>
#include <pliant/solver/linear/chebyshev.hpp>
#include <pliant/solver/linear/multilevel.hpp>

namespace pliant::detail {

/// Rigid motions of nodes, (nodes, Dim, modes): translations, and rotations about the middle of the nodes, with 1 as
/// their largest entries. Entries of directions that `fixed` names are zero.
template <int Dim>
std::vector<double> rigid_motions(std::vector<Point<Dim>> const& nodes,
                                  std::vector<bool> const& fixed) {
  constexpr int modes = Dim * (Dim + 1) / 2;
  Point<Dim> middle{};
  for (auto const& x : nodes)
    for (std::size_t k = 0; k < Dim; ++k) middle[k] += x[k] / static_cast<double>(nodes.size());
  double radius = 0;
  for (auto const& x : nodes)
    for (std::size_t k = 0; k < Dim; ++k) radius = std::max(radius, std::abs(x[k] - middle[k]));
  if (!(radius > 0)) radius = 1;
  std::vector<double> motions(nodes.size() * Dim * modes, 0.0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    auto const entry = [&](std::size_t k, int mode) -> double& {
      return motions[(Dim * i + k) * modes + static_cast<std::size_t>(mode)];
    };
    int mode = 0;
    for (std::size_t k = 0; k < Dim; ++k) entry(k, mode++) = 1;
    for (std::size_t k = 0; k < Dim; ++k)
      for (std::size_t l = k + 1; l < Dim; ++l, ++mode) {
        entry(k, mode) = -(nodes[i][l] - middle[l]) / radius;
        entry(l, mode) = (nodes[i][k] - middle[k]) / radius;
      }
    for (std::size_t k = 0; k < Dim; ++k)
      if (fixed[Dim * i + k])
        for (int m = 0; m < modes; ++m) entry(k, m) = 0;
  }
  return motions;
}

template <int Dim>
class Multilevel<Dim>::Hierarchy {
 public:
  static constexpr int modes = Dim * (Dim + 1) / 2;

  Hierarchy(HostTasks const& tasks, BlockMatrix<Dim, Dim> a, std::vector<Point<Dim>> const& nodes,
            std::vector<bool> const& fixed) {
    fine_ = std::make_unique<Level<Dim>>(tasks, std::move(a));
    auto motions = rigid_motions<Dim>(nodes, fixed);
    auto next = coarser(tasks, *fine_, motions);
    while (next) {
      coarse_.push_back(std::make_unique<Level<modes>>(tasks, std::move(*next)));
      if (coarse_.back()->a.rows() <= coarsest_rows) break;
      next = coarser(tasks, *coarse_.back(), motions);
    }
    factorise_coarsest();
  }

  int levels() const { return 1 + static_cast<int>(coarse_.size()); }
  BlockMatrix<Dim, Dim> const& matrix() const { return fine_->a; }
  double operator_complexity() const {
    double all = static_cast<double>(fine_->a.values.size());
    for (auto const& level : coarse_) all += static_cast<double>(level->a.values.size());
    return all / static_cast<double>(fine_->a.values.size());
  }

  bool is_definite() const {
    if (coarsest_.info() != Eigen::Success) return false;
    Eigen::VectorXd const pivots = coarsest_.vectorD();
    return pivots.size() == 0 || pivots.minCoeff() > 1e-13 * pivots.maxCoeff();
  }
  void apply(HostTasks const& tasks, Eigen::VectorXd const& r, Eigen::VectorXd& z) {
    cycle(tasks, *fine_, 0, r, z);
  }

 private:
  static constexpr Index coarsest_rows = 80;

  template <int N>
  struct Level {
    BlockMatrix<N, N> a;
    Chebyshev<N> smoother;
    BlockMatrix<N, modes> prolongation;
    BlockMatrix<modes, N> restriction;
    Eigen::VectorXd residual, coarse_residual, coarse_correction, correction;

    Level(HostTasks const& tasks, BlockMatrix<N, N> matrix)
        : a(std::move(matrix)), smoother(tasks, a) {}
  };

  /// The columns that `motions` have on each aggregate, made orthonormal; `motions` become the coefficients that give the
  /// former ones back. A column that depends on those before it is zero.
  template <int N>
  static BlockMatrix<N, modes> tentative(Aggregates const& sets, std::vector<double>& motions) {
    auto const rows = sets.of.size();
    BlockMatrix<N, modes> p;
    p.columns = sets.count;
    p.first.resize(rows + 1);
    std::vector<std::vector<Index>> members(static_cast<std::size_t>(sets.count));
    for (std::size_t i = 0; i < rows; ++i) {
      p.first[i + 1] = p.first[i] + (sets.of[i] >= 0);
      if (sets.of[i] < 0) continue;
      p.column.push_back(sets.of[i]);
      members[static_cast<std::size_t>(sets.of[i])].push_back(static_cast<Index>(i));
    }
    p.clear_values();
    std::vector<double> coarse(members.size() * modes * modes, 0.0);
    for (std::size_t set = 0; set < members.size(); ++set) {
      auto const& list = members[set];
      Eigen::Matrix<double, Eigen::Dynamic, modes> q(N * std::ssize(list), modes);
      for (std::size_t i = 0; i < list.size(); ++i)
        for (int r = 0; r < N; ++r)
          for (int m = 0; m < modes; ++m)
            q(static_cast<Eigen::Index>(N * i) + r, m) =
                motions[(N * static_cast<std::size_t>(list[i]) + static_cast<std::size_t>(r)) *
                            modes +
                        static_cast<std::size_t>(m)];
      Eigen::Matrix<double, modes, modes> coefficients =
          Eigen::Matrix<double, modes, modes>::Zero();
      for (int m = 0; m < modes; ++m) {
        double const before = q.col(m).norm();
        for (int again = 0; again < 2; ++again)
          for (int l = 0; l < m; ++l) {
            double const share = q.col(l).dot(q.col(m));
            coefficients(l, m) += share;
            q.col(m) -= share * q.col(l);
          }
        double const left = q.col(m).norm();
        if (left > 1e-8 * before) {
          coefficients(m, m) = left;
          q.col(m) /= left;
        } else {
          q.col(m).setZero();
        }
      }
      for (std::size_t i = 0; i < list.size(); ++i) {
        double* const block = p.at(p.begin(list[i]));
        for (int r = 0; r < N; ++r)
          for (int m = 0; m < modes; ++m)
            block[modes * r + m] = q(static_cast<Eigen::Index>(N * i) + r, m);
      }
      for (int r = 0; r < modes; ++r)
        for (int m = 0; m < modes; ++m)
          coarse[(set * modes + static_cast<std::size_t>(r)) * modes +
                 static_cast<std::size_t>(m)] = coefficients(r, m);
    }
    motions = std::move(coarse);
    return p;
  }

  /// Gives a level its prolongation, and returns the coarser matrix; none where there is nothing to gain.
  template <int N>
  std::unique_ptr<BlockMatrix<modes, modes>> coarser(HostTasks const& tasks, Level<N>& level,
                                                     std::vector<double>& motions) {
    auto const& a = level.a;
    auto const sets = aggregate(a, strong_coupling);
    if (sets.count == 0 || 4 * std::int64_t{sets.count} * modes > 3 * std::int64_t{a.rows()} * N)
      return nullptr;
    auto const p = tentative<N>(sets, motions);
    auto smooth = product(tasks, a, p);
    double const omega = 4.0 / 3 / level.smoother.largest();
    tasks.in_parts(a.rows(), 256, [&](Index from, Index to) {
      for (Index row = from; row < to; ++row)
        for (auto place = smooth.begin(row); place < smooth.end(row); ++place) {
          double scaled[N * modes]{};
          level.smoother.jacobi().template add_product_of<modes>(row, smooth.at(place), scaled);
          double* const block = smooth.at(place);
          for (int k = 0; k < N * modes; ++k) block[k] = -omega * scaled[k];
          if (p.begin(row) < p.end(row) && p.column_at(p.begin(row)) == smooth.column_at(place))
            for (int k = 0; k < N * modes; ++k) block[k] += p.at(p.begin(row))[k];
        }
    });
    level.restriction = transposed(smooth);
    auto coarse = std::make_unique<BlockMatrix<modes, modes>>(
        product(tasks, level.restriction, product(tasks, a, smooth)));
    level.prolongation = std::move(smooth);
    give_diagonal_to_absent_modes(*coarse);
    return coarse;
  }

  static void give_diagonal_to_absent_modes(BlockMatrix<modes, modes>& a) {
    auto const entry = [&](Index row, int k) -> double& {
      return a.at(a.find(row, row))[(modes + 1) * k];
    };
    double largest = 0;
    for (Index row = 0; row < a.rows(); ++row)
      for (int k = 0; k < modes; ++k) largest = std::max(largest, entry(row, k));
    for (Index row = 0; row < a.rows(); ++row)
      for (int k = 0; k < modes; ++k)
        if (entry(row, k) == 0) entry(row, k) = largest;
  }

  void factorise_coarsest() {
    if (coarse_.empty())
      factorise(fine_->a);
    else
      factorise(coarse_.back()->a);
  }
  template <int N>
  void factorise(BlockMatrix<N, N> const& a) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index row = 0; row < a.rows(); ++row)
      for (auto place = a.begin(row); place < a.end(row); ++place)
        for (int r = 0; r < N; ++r)
          for (int c = 0; c < N; ++c)
            entries.emplace_back(N * row + r, N * a.column_at(place) + c, a.at(place)[N * r + c]);
    Eigen::SparseMatrix<double> sparse(N * a.rows(), N * a.rows());
    sparse.setFromTriplets(entries.begin(), entries.end());
    coarsest_.compute(sparse);
  }

  template <int N>
  void cycle(HostTasks const& tasks, Level<N>& level, std::size_t next, Eigen::VectorXd const& b,
             Eigen::VectorXd& x) {
    if (next == coarse_.size()) {
      x = coarsest_.solve(b);
      return;
    }
    level.smoother.smooth(tasks, level.a, b, x, true);
    multiply(tasks, level.a, x, level.residual);
    level.residual = b - level.residual;
    multiply(tasks, level.restriction, level.residual, level.coarse_residual);
    cycle(tasks, *coarse_[next], next + 1, level.coarse_residual, level.coarse_correction);
    multiply(tasks, level.prolongation, level.coarse_correction, level.correction);
    x += level.correction;
    level.smoother.smooth(tasks, level.a, b, x, false);
  }

  static constexpr double strong_coupling = 0.02;
  std::unique_ptr<Level<Dim>> fine_;
  std::vector<std::unique_ptr<Level<modes>>> coarse_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
};

template <int Dim>
Multilevel<Dim>::Multilevel(HostTasks const& tasks, BlockMatrix<Dim, Dim> a,
                            std::vector<Point<Dim>> const& nodes, std::vector<bool> const& fixed)
    : hierarchy_(std::make_unique<Hierarchy>(tasks, std::move(a), nodes, fixed)) {}
template <int Dim>
Multilevel<Dim>::Multilevel(Multilevel&&) noexcept = default;
template <int Dim>
Multilevel<Dim>& Multilevel<Dim>::operator=(Multilevel&&) noexcept = default;
template <int Dim>
Multilevel<Dim>::~Multilevel() = default;

template <int Dim>
int Multilevel<Dim>::levels() const {
  return hierarchy_->levels();
}
template <int Dim>
BlockMatrix<Dim, Dim> const& Multilevel<Dim>::matrix() const {
  return hierarchy_->matrix();
}
template <int Dim>
double Multilevel<Dim>::operator_complexity() const {
  return hierarchy_->operator_complexity();
}
template <int Dim>
bool Multilevel<Dim>::is_definite() const {
  return hierarchy_->is_definite();
}
template <int Dim>
void Multilevel<Dim>::apply(HostTasks const& tasks, Eigen::VectorXd const& r, Eigen::VectorXd& z) {
  hierarchy_->apply(tasks, r, z);
}

}  // namespace pliant::detail
