#pragma once

#include <cmath>
#include <vector>

#include <pliant/solver/linear/block_matrix.hpp>

namespace pliant::detail {

/// Disjoint sets of rows that are strongly coupled: each becomes a row of a coarser matrix.
struct Aggregates {
  std::vector<Index> of;  // of each row; −1: of none, coupled to no other
  Index count = 0;
};

/// Rows couple strongly where |A_ij| > threshold √(|A_ii| |A_jj|), in Frobenius' norm. A row whose neighbours are all free
/// makes a set with them; what is left joins its strongest neighbour's (Vaněk, Mandel, Brezina 1996).
template <int N>
Aggregates aggregate(BlockMatrix<N, N> const& a, double threshold) {
  auto const norm = [&](std::int64_t place) {
    double sum = 0;
    for (std::size_t k = 0; k < a.block; ++k) sum += a.at(place)[k] * a.at(place)[k];
    return sum;
  };
  auto const at = [](auto i) { return static_cast<std::size_t>(i); };
  auto const rows = a.rows();
  std::vector<double> own(at(rows));
  for (Index i = 0; i < rows; ++i) own[at(i)] = norm(a.find(i, i));

  std::vector<Index> neighbour;
  std::vector<double> coupling;
  std::vector<std::int64_t> first(at(rows) + 1);
  double const squared = threshold * threshold;
  for (Index i = 0; i < rows; ++i) {
    for (auto place = a.begin(i); place < a.end(i); ++place) {
      Index const j = a.column_at(place);
      if (j == i) continue;
      double const size = norm(place);
      if (!(size > squared * std::sqrt(own[at(i)] * own[at(j)]))) continue;
      neighbour.push_back(j);
      coupling.push_back(size);
    }
    first[at(i) + 1] = std::ssize(neighbour);
  }

  Aggregates sets{std::vector<Index>(at(rows), -1), 0};
  auto& of = sets.of;
  auto const for_each_neighbour = [&](Index i, auto const& visit) {
    for (auto k = first[at(i)]; k < first[at(i) + 1]; ++k) visit(neighbour[at(k)], coupling[at(k)]);
  };
  for (Index i = 0; i < rows; ++i) {
    bool all_free = of[at(i)] < 0 && first[at(i)] < first[at(i) + 1];
    for_each_neighbour(i, [&](Index j, double) { all_free = all_free && of[at(j)] < 0; });
    if (!all_free) continue;
    of[at(i)] = sets.count;
    for_each_neighbour(i, [&](Index j, double) { of[at(j)] = sets.count; });
    ++sets.count;
  }
  std::vector<Index> const roots = of;
  for (Index i = 0; i < rows; ++i) {
    if (of[at(i)] >= 0) continue;
    double strongest = 0;
    for_each_neighbour(i, [&](Index j, double size) {
      if (roots[at(j)] < 0 || size <= strongest) return;
      strongest = size;
      of[at(i)] = roots[at(j)];
    });
  }
  for (Index i = 0; i < rows; ++i) {
    if (of[at(i)] >= 0 || first[at(i)] == first[at(i) + 1]) continue;
    of[at(i)] = sets.count;
    for_each_neighbour(i, [&](Index j, double) {
      if (of[at(j)] < 0) of[at(j)] = sets.count;
    });
    ++sets.count;
  }
  return sets;
}

}  // namespace pliant::detail
