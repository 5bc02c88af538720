#pragma once

#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <pliant/solver/linear/block_matrix.hpp>

namespace pliant::detail {

/// Which entries of vectors over (node, direction) are unknown, and vectors and matrices of these alone.
class Unknowns {
 public:
  explicit Unknowns(std::vector<bool> fixed)
      : fixed_(std::move(fixed)), number_(fixed_.size(), -1) {
    for (std::size_t i = 0; i < fixed_.size(); ++i)
      if (!fixed_[i]) number_[i] = count_++;
  }
  Index count() const { return count_; }
  /// Entries of a whole vector.
  Eigen::Index size() const { return static_cast<Eigen::Index>(number_.size()); }
  std::vector<bool> const& fixed() const { return fixed_; }

  Eigen::VectorXd restrict(Eigen::VectorXd const& full) const {
    Eigen::VectorXd reduced(count_);
    for (std::size_t i = 0; i < number_.size(); ++i)
      if (number_[i] >= 0) reduced[number_[i]] = full[static_cast<Eigen::Index>(i)];
    return reduced;
  }
  Eigen::SparseMatrix<double> restrict(Eigen::SparseMatrix<double> const& full) const {
    return filtered<Eigen::SparseMatrix<double>>([&](std::size_t column, auto const& add) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(full, static_cast<Eigen::Index>(column));
           it; ++it)
        add(it.row(), it.value());
    });
  }
  template <int N>
  Eigen::SparseMatrix<double> restrict(BlockMatrix<N, N> const& full) const {
    return filtered<Eigen::SparseMatrix<double, Eigen::RowMajor>>(
        [&](std::size_t scalar_row, auto const& add) {
          auto const row = static_cast<Index>(scalar_row / N);
          auto const r = scalar_row % N;
          for (auto place = full.begin(row); place < full.end(row); ++place)
            for (int c = 0; c < N; ++c)
              add(Eigen::Index{N} * full.column_at(place) + c,
                  full.at(place)[N * r + static_cast<std::size_t>(c)]);
        });
  }
  /// `reduced`, and zeros elsewhere.
  Eigen::VectorXd expand(Eigen::VectorXd const& reduced) const {
    Eigen::VectorXd full = Eigen::VectorXd::Zero(size());
    for (std::size_t i = 0; i < number_.size(); ++i)
      if (number_[i] >= 0) full[static_cast<Eigen::Index>(i)] = reduced[number_[i]];
    return full;
  }
  /// Sets all but the unknowns to zero.
  void keep(Eigen::VectorXd& full) const {
    for (std::size_t i = 0; i < number_.size(); ++i)
      if (number_[i] < 0) full[static_cast<Eigen::Index>(i)] = 0;
  }
  /// Sets rows and columns of all but the unknowns to zero, and their diagonal to the mean of the unknowns'.
  template <int N>
  void isolate_others(BlockMatrix<N, N>& a) const {
    double mean = 0;
    for (Index row = 0; row < a.rows(); ++row)
      for (std::size_t r = 0; r < N; ++r)
        if (!fixed_[N * static_cast<std::size_t>(row) + r])
          mean += a.at(a.find(row, row))[(N + 1) * r] / count_;
    for (Index row = 0; row < a.rows(); ++row)
      for (auto place = a.begin(row); place < a.end(row); ++place)
        for (std::size_t r = 0; r < N; ++r)
          for (std::size_t c = 0; c < N; ++c) {
            auto const i = N * static_cast<std::size_t>(row) + r;
            auto const j = N * static_cast<std::size_t>(a.column_at(place)) + c;
            if (fixed_[i] || fixed_[j]) a.at(place)[N * r + c] = i == j ? mean : 0;
          }
  }

 private:
  /// entries(i, add) calls add(j, value) for the entries of row or column i, with j ascending.
  template <class Matrix, class Entries>
  Eigen::SparseMatrix<double> filtered(Entries const& entries) const {
    Matrix reduced(count_, count_);
    std::vector<int> inner;
    std::vector<double> values;
    int* const outer = reduced.outerIndexPtr();
    for (std::size_t i = 0; i < number_.size(); ++i) {
      if (number_[i] < 0) continue;
      entries(i, [&](Eigen::Index j, double value) {
        if (number_[static_cast<std::size_t>(j)] < 0) return;
        inner.push_back(number_[static_cast<std::size_t>(j)]);
        values.push_back(value);
      });
      outer[number_[i] + 1] = static_cast<int>(inner.size());
    }
    reduced.resizeNonZeros(static_cast<Eigen::Index>(inner.size()));
    std::ranges::copy(inner, reduced.innerIndexPtr());
    std::ranges::copy(values, reduced.valuePtr());
    return reduced;
  }

  std::vector<bool> fixed_;
  std::vector<Index> number_;  // −1 where fixed
  Index count_ = 0;
};

}  // namespace pliant::detail
