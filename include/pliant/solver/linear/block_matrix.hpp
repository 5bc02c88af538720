#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <pliant/backend/host_tasks.hpp>

namespace pliant {

/// A sparse matrix of R × C blocks, on the host: compressed rows of blocks, with columns ascending within a row.
template <int R, int C>
struct BlockMatrix {
  static constexpr std::size_t block = std::size_t{R} * C;

  Index columns = 0;                   // of blocks
  std::vector<std::int64_t> first{0};  // of each row's blocks, and one past the last
  std::vector<Index> column;           // of each block
  std::vector<double> values;          // block after block, each by rows

  Index rows() const { return static_cast<Index>(first.size()) - 1; }
  std::int64_t blocks() const { return first.back(); }
  double* at(std::int64_t place) { return values.data() + block * static_cast<std::size_t>(place); }
  double const* at(std::int64_t place) const {
    return values.data() + block * static_cast<std::size_t>(place);
  }
  std::int64_t begin(Index row) const { return first[static_cast<std::size_t>(row)]; }
  std::int64_t end(Index row) const { return first[static_cast<std::size_t>(row) + 1]; }
  Index column_at(std::int64_t place) const { return column[static_cast<std::size_t>(place)]; }
  /// The place of a block; −1 where there is none.
  std::int64_t find(Index row, Index of_column) const {
    auto const from = column.begin() + begin(row), to = column.begin() + end(row);
    auto const found = std::lower_bound(from, to, of_column);
    return found != to && *found == of_column ? found - column.begin() : -1;
  }
  /// Makes room for the blocks that `column` names, all zero.
  void clear_values() { values.assign(block * column.size(), 0.0); }
};

namespace detail {

/// c += a b, of small dense matrices by rows: R × K and K × C.
template <int R, int K, int C>
void add_product(double* c, double const* a, double const* b) {
  for (int r = 0; r < R; ++r)
    for (int k = 0; k < K; ++k)
      for (int j = 0; j < C; ++j) c[C * r + j] += a[K * r + k] * b[C * k + j];
}

/// y = a x.
template <int R, int C>
void multiply(HostTasks const& tasks, BlockMatrix<R, C> const& a, Eigen::VectorXd const& x,
              Eigen::VectorXd& y) {
  y.resize(Eigen::Index{R} * a.rows());
  tasks.in_parts(a.rows(), 1024, [&](Index from, Index to) {
    for (Index row = from; row < to; ++row) {
      double sum[R]{};
      for (auto place = a.begin(row); place < a.end(row); ++place) {
        double const* const m = a.at(place);
        double const* const v = x.data() + Eigen::Index{C} * a.column_at(place);
        for (int r = 0; r < R; ++r)
          for (int c = 0; c < C; ++c) sum[r] += m[C * r + c] * v[c];
      }
      for (int r = 0; r < R; ++r) y[Eigen::Index{R} * row + r] = sum[r];
    }
  });
}

/// a += factor b, where a has a place for each block of b.
template <int R, int C>
void add_scaled(BlockMatrix<R, C>& a, double factor, BlockMatrix<R, C> const& b) {
  for (Index row = 0; row < b.rows(); ++row)
    for (auto place = b.begin(row); place < b.end(row); ++place) {
      double* const to = a.at(a.find(row, b.column_at(place)));
      for (std::size_t k = 0; k < b.block; ++k) to[k] += factor * b.at(place)[k];
    }
}

template <int R, int C>
BlockMatrix<C, R> transposed(BlockMatrix<R, C> const& a) {
  BlockMatrix<C, R> t;
  t.columns = a.rows();
  t.first.assign(static_cast<std::size_t>(a.columns) + 1, 0);
  for (Index column : a.column) ++t.first[static_cast<std::size_t>(column) + 1];
  for (std::size_t i = 1; i < t.first.size(); ++i) t.first[i] += t.first[i - 1];
  t.column.resize(a.column.size());
  t.clear_values();
  std::vector<std::int64_t> next(t.first.begin(), t.first.end() - 1);
  for (Index row = 0; row < a.rows(); ++row)
    for (auto place = a.begin(row); place < a.end(row); ++place) {
      auto const to = next[static_cast<std::size_t>(a.column_at(place))]++;
      t.column[static_cast<std::size_t>(to)] = row;
      for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c) t.at(to)[R * c + r] = a.at(place)[C * r + c];
    }
  return t;
}

/// a b, row by row (Gustavson 1978).
template <int R, int K, int C>
BlockMatrix<R, C> product(HostTasks const& tasks, BlockMatrix<R, K> const& a,
                          BlockMatrix<K, C> const& b) {
  BlockMatrix<R, C> out;
  out.columns = b.columns;
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(a.rows()));
  tasks.in_parts(a.rows(), 256, [&](Index from, Index to) {
    std::vector<Index> seen(static_cast<std::size_t>(b.columns), -1);
    for (Index row = from; row < to; ++row) {
      auto& list = columns[static_cast<std::size_t>(row)];
      for (auto i = a.begin(row); i < a.end(row); ++i)
        for (auto j = b.begin(a.column_at(i)); j < b.end(a.column_at(i)); ++j)
          if (std::exchange(seen[static_cast<std::size_t>(b.column_at(j))], row) != row)
            list.push_back(b.column_at(j));
      std::ranges::sort(list);
    }
  });
  out.first.resize(columns.size() + 1);
  for (std::size_t row = 0; row < columns.size(); ++row)
    out.first[row + 1] = out.first[row] + static_cast<std::int64_t>(columns[row].size());
  out.column.resize(static_cast<std::size_t>(out.blocks()));
  out.clear_values();
  tasks.in_parts(a.rows(), 256, [&](Index from, Index to) {
    std::vector<std::int64_t> place_of(static_cast<std::size_t>(b.columns));
    for (Index row = from; row < to; ++row) {
      auto const& list = columns[static_cast<std::size_t>(row)];
      std::ranges::copy(list, out.column.begin() + out.begin(row));
      for (std::size_t k = 0; k < list.size(); ++k)
        place_of[static_cast<std::size_t>(list[k])] = out.begin(row) + static_cast<std::int64_t>(k);
      for (auto i = a.begin(row); i < a.end(row); ++i)
        for (auto j = b.begin(a.column_at(i)); j < b.end(a.column_at(i)); ++j)
          add_product<R, K, C>(out.at(place_of[static_cast<std::size_t>(b.column_at(j))]), a.at(i),
                               b.at(j));
    }
  });
  return out;
}

}  // namespace detail
}  // namespace pliant
