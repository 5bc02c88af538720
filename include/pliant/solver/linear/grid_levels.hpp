#pragma once

#include <pliant/solver/linear/dense_inverse.hpp>
#include <pliant/solver/linear/polynomial_smoother.hpp>
#include <pliant/solver/linear/stencil_matrix.hpp>

namespace pliant::detail {

/// Nested grids, each with Galerkin's matrix of the one before, and the correction that they give together: a V-cycle
/// (Briggs, Henson, McCormick, A Multigrid Tutorial, 2000), with a dense inverse at its end.
template <Backend B, int Dim>
class GridLevels {
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;
  using Field = NodeField<T, Dim>;
  using ConstField = NodeField<T const, Dim>;

 public:
  GridLevels() = default;
  /// `finest` with numbers, around nodes at `rest`, in the boxes that `boxes_of` them tells.
  GridLevels(B const& backend, BackgroundGrid<Dim> finest, Array<T> const& rest,
             std::vector<Index> boxes_of) {
    auto const* finer = &rest;
    for (auto grid = std::move(finest);;) {
      levels_.emplace_back(backend, grid, *finer, boxes_of);
      if (static_cast<Index>(grid.node.size()) * Dim <= most_dense || !grid.can_be_coarser()) break;
      auto next = grid.coarser();
      boxes_of.resize(grid.node.size());
      for (std::size_t i = 0; i < grid.node.size(); ++i)
        for (std::size_t b = 0; b < grid.corners; ++b)
          if (Index const box = grid.around[grid.corners * i + b]; box >= 0)
            boxes_of[i] = next.find_box(next.parent_of(grid.box[static_cast<std::size_t>(box)]));
      grid = std::move(next);
      finer = &levels_.back().grid.rest();
    }
    auto const size = static_cast<std::size_t>(levels_.back().grid.nodes()) * Dim;
    inverse_ = zeros<T>(backend, size * size);
  }
  bool empty() const { return levels_.empty(); }
  int count() const { return static_cast<int>(levels_.size()); }
  GridView<T, Dim> const& finest() const { return levels_.front().grid.view(); }
  GridView<T, Dim> const& grid(int level) const { return at(level).grid.view(); }
  Array<T> const& rest(int level) const { return at(level).grid.rest(); }
  StencilView<T, Dim> matrix(int level) const { return at(level).matrix(); }
  Field right_side() const { return at(0).field(at(0).b); }
  Field correction() const { return at(0).field(at(0).x); }

  void clear_finest_matrix(B const& backend) {
    backend.for_each(levels_.front().grid.nodes(), ClearStencil<T, Dim>{matrix(0)});
  }
  /// Makes the coarser matrices, and what smooths, from the finest.
  void prepare(B const& backend) {
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
      auto& level = levels_[l];
      auto& next = levels_[l + 1];
      backend.for_each(next.grid.nodes() * BackgroundGrid<Dim>::neighbours,
                       GalerkinBlock<T, Dim>{next.matrix(), level.matrix(), next.grid.view()});
      InvertDiagonal<T, Dim, StencilView<T, Dim>> invert{level.matrix(), {}};
      for (int k = 0; k < Dim; ++k) invert.columns[k] = level.column(k);
      backend.for_each(level.grid.nodes(), invert);
      double const largest =
          1.1 * largest_eigenvalue_on(backend, level.fields(), level.product(backend));
      level.per_largest.upload(std::vector{static_cast<T>(1 / largest)});
    }
    invert_coarsest();
  }
  /// correction = V-cycle(right side).
  void cycle(B const& backend, SmoothingPolynomial const& smoothing, std::size_t l = 0) const {
    auto const& level = levels_[l];
    auto const fields = level.fields();
    if (l + 1 == levels_.size()) {
      Index const size = Dim * level.grid.nodes();
      backend.for_each(size,
                       DenseProduct<T, Dim>{inverse_.data(), size, fields.x, {fields.b.data}});
      return;
    }
    auto const& next = levels_[l + 1];
    cycle_around(backend, fields, smoothing, level.product(backend), [&] {
      auto const coarse = next.fields();
      backend.for_each(
          next.grid.nodes(),
          Restrict<T, Dim>{next.grid.view(), coarse.b, {fields.b.data}, {fields.q.data}});
      cycle(backend, smoothing, l + 1);
      backend.for_each(
          level.grid.nodes(),
          AddInterpolated<T, Dim>{next.grid.view(), fields.x, {coarse.x.data}, nullptr, nullptr});
    });
  }
  /// x += V-cycle of what b − q is, over the nodes around which the finest grid lies; `mass` and `held` tell their unknowns.
  void correct(B const& backend, SmootherFields<T, Dim> const& f,
               SmoothingPolynomial const& smoothing, T const* mass,
               DirectionMask const* held) const {
    backend.for_each(finest().nodes,
                     Restrict<T, Dim>{finest(), right_side(), {f.b.data}, {f.q.data}});
    cycle(backend, smoothing);
    backend.for_each(f.n, AddInterpolated<T, Dim>{finest(), f.x, {correction().data}, mass, held});
  }

 private:
  struct Level {
    GridFunctions<B, Dim> grid;
    Array<T> entries, blocks;  // of the matrix; inverses of its diagonal: (Dim, nodes, 4)
    Array<T> b, x, d, q;       // (nodes, 4)
    Array<T> per_largest;      // (1): see SmoothingStep

    Level(B const& backend, BackgroundGrid<Dim> const& numbers, Array<T> const& finer,
          std::vector<Index> const& boxes_of)
        : grid(backend, numbers, finer, boxes_of),
          entries(zeros<T>(backend, StencilView<T, Dim>::size(grid.nodes()))),
          per_largest(zeros<T>(backend, 1)) {
      auto const rows =
          static_cast<std::size_t>(node_stride) * static_cast<std::size_t>(grid.nodes());
      blocks = zeros<T>(backend, Dim * rows);
      for (auto* array : {&b, &x, &d, &q}) *array = zeros<T>(backend, rows);
    }
    static Field field(Array<T> const& array) { return {const_cast<T*>(array.data())}; }
    Field column(int k) const {
      return {field(blocks).data + static_cast<std::ptrdiff_t>(k) * node_stride * grid.nodes()};
    }
    StencilView<T, Dim> matrix() const {
      return {const_cast<T*>(entries.data()), grid.view().neighbour};
    }
    SmootherFields<T, Dim> fields() const {
      SmootherFields<T, Dim> f{grid.nodes(), field(b), field(x),          field(d),
                               field(q),     {},       per_largest.data()};
      for (int k = 0; k < Dim; ++k) f.columns[k] = {column(k).data};
      return f;
    }
    auto product(B const& backend) const {
      return [&backend, n = grid.nodes(), a = matrix()](Field from, Field to) {
        backend.for_each(n, StencilProduct<T, Dim>{a, to, {from.data}});
      };
    }
  };
  Level const& at(int level) const { return levels_[static_cast<std::size_t>(level)]; }

  void invert_coarsest() {
    auto const& level = levels_.back();
    Index const n = level.grid.nodes();
    auto entries = download<T>(level.entries);
    auto const neighbour = download<Index>(level.grid.neighbours());
    StencilView<T, Dim> const a{entries.data(), neighbour.data()};
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(Dim * n, Dim * n);
    for (Index i = 0; i < n; ++i)
      for (int o = 0; o < a.neighbours; ++o)
        if (Index const j = neighbour[static_cast<std::size_t>(a.neighbours * i + o)]; j >= 0)
          for (int k = 0; k < Dim; ++k)
            for (int l = 0; l < Dim; ++l)
              dense(Dim * i + k, Dim * j + l) = static_cast<double>(a(i, o, k, l));
    Eigen::MatrixXd const inverse = inverse_of_definite(std::move(dense));
    std::vector<T> values(static_cast<std::size_t>(inverse.size()));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<T>(inverse.data()[k]);
    inverse_.upload(values);
  }

  static constexpr Index most_dense = 300;  // unknowns
  std::vector<Level> levels_;
  Array<T> inverse_;  // of the coarsest matrix, (Dim nodes)²
};

}  // namespace pliant::detail
