#pragma once

#include <algorithm>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/solver/linear/stencil_matrix.hpp>

namespace pliant::detail {

/// A sparse matrix of Dim × Dim blocks in a backend's memory, for rows of any length (sliced ELLPACK: Monakov, Lokhmotov,
/// Avetisyan, Automatically tuning sparse matrix-vector multiplication for GPU architectures, 2010). Entries of 32 rows lie
/// side by side, as threads of a GPU read them; the diagonal is the first of each row.
template <class T, int Dim>
struct SlicedView {
  static constexpr int together = 32, entries_per_block = Dim * Dim;
  T* entries;
  Index const* begin;   // (slices + 1): blocks of a row before a slice
  Index const* column;  // behind −1 a row has none

  PLIANT_HOST_DEVICE std::ptrdiff_t place(Index row, int slot) const {
    return static_cast<std::ptrdiff_t>(begin[row / together] + slot) * together + row % together;
  }
  PLIANT_HOST_DEVICE int slots(Index row) const {
    return begin[row / together + 1] - begin[row / together];
  }
  PLIANT_HOST_DEVICE Index column_at(Index row, int slot) const { return column[place(row, slot)]; }
  /// The slot of an entry that is there.
  PLIANT_HOST_DEVICE int slot_of(Index row, Index of) const {
    int slot = 0;
    while (column_at(row, slot) != of) ++slot;
    return slot;
  }
  PLIANT_HOST_DEVICE T& operator()(Index row, int slot, int k, int l) const {
    auto const at = place(row, slot);
    return entries[(at / together * entries_per_block + Dim * k + l) * together + at % together];
  }
  PLIANT_HOST_DEVICE Tensor<T, Dim> block(Index row, int slot) const {
    Tensor<T, Dim> a;
    for (int k = 0; k < Dim; ++k)
      for (int l = 0; l < Dim; ++l) a(k, l) = (*this)(row, slot, k, l);
    return a;
  }
  PLIANT_HOST_DEVICE Tensor<T, Dim> diagonal(Index row) const { return block(row, 0); }
};

/// y = A x.
template <class T, int Dim>
struct SlicedProduct {
  SlicedView<T, Dim> a;
  NodeField<T, Dim> y;
  NodeField<T const, Dim> x;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto sum = Vector<T, Dim>::zero();
    int const slots = a.slots(i);
    for (int slot = 0; slot < slots; ++slot) {
      Index const j = a.column_at(i, slot);
      if (j < 0) break;
      sum = sum + a.block(i, slot) * x.at(j);
    }
    y.set(i, sum);
  }
};

/// The entries of a SlicedView.
template <Backend B, int Dim>
class SlicedMatrix {
  using T = typename B::scalar;
  using View = SlicedView<T, Dim>;

 public:
  SlicedMatrix() = default;
  /// `columns` of each row, its own first.
  SlicedMatrix(B const& backend, std::vector<std::vector<Index>> const& columns) {
    std::vector<Index> begin{0};
    for (std::size_t row = 0; row < columns.size(); row += View::together) {
      std::size_t most = 0;
      for (auto r = row; r < std::min(row + View::together, columns.size()); ++r)
        most = std::max(most, columns[r].size());
      begin.push_back(begin.back() + static_cast<Index>(most));
    }
    auto const places = static_cast<std::size_t>(begin.back()) * View::together;
    std::vector<Index> column(places, -1);
    View const view{nullptr, begin.data(), column.data()};
    for (std::size_t row = 0; row < columns.size(); ++row)
      for (std::size_t slot = 0; slot < columns[row].size(); ++slot)
        column[static_cast<std::size_t>(
            view.place(static_cast<Index>(row), static_cast<int>(slot)))] = columns[row][slot];
    begin_ = upload(backend, begin);
    column_ = upload(backend, column);
    entries_ = zeros<T>(backend, places * View::entries_per_block);
  }
  View view() const { return {const_cast<T*>(entries_.data()), begin_.data(), column_.data()}; }
  void clear(B const& backend) const {
    backend.for_each(static_cast<Index>(entries_.size() / node_stride), Clear<T>{view().entries});
  }

 private:
  typename B::template Array<T> entries_;
  typename B::template Array<Index> begin_, column_;
};

}  // namespace pliant::detail
