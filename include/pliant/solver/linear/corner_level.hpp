#pragma once

#include <pliant/solver/linear/corner_functors.hpp>
#include <pliant/solver/linear/corners_of_body.hpp>
#include <pliant/solver/linear/grid_levels.hpp>
#include <pliant/solver/linear/grid_of_body.hpp>

namespace pliant::detail {

/// The second level of p-multigrid (Rønquist and Patera, Journal of Scientific Computing 2 (1987) 389): linear elements on
/// the cells of a body's quadratic ones, with Galerkin's matrix.
template <class Parts>
class CornerLevel {
  using T = typename Parts::T;
  using B = typename Parts::backend_type;
  static constexpr int dim = Parts::dim;
  using Field = NodeField<T, dim>;
  template <class U>
  using Array = typename Parts::template Array<U>;
  using Arrays = SolverArrays<B>;
  using Homes = std::vector<ElementHomes<B, dim>>;

 public:
  CornerLevel(Parts const& parts, CornersOfBody const& corners)
      : count_(static_cast<Index>(corners.node.size())),
        node_(upload(parts.backend, corners.node)),
        between_(parts.backend, corners.between),
        matrix_(parts.backend, corners.neighbours),
        held_(zeros<DirectionMask>(parts.backend, corners.node.size())),
        per_largest_(zeros<T>(parts.backend, 1)) {
    std::vector<T> share(corners.share.size());
    std::ranges::transform(corners.share, share.begin(),
                           [](double x) { return static_cast<T>(x); });
    share_ = upload(parts.backend, share);
    for (auto* array : {&rest_, &b_, &x_, &d_, &q_})
      *array = zeros<T>(parts.backend, node_stride * corners.node.size());
    mass_ = zeros<T>(parts.backend, corners.node.size());
    blocks_ = zeros<T>(parts.backend, dim * rest_.size());
    take(parts, {parts.layout.rest.data()}, field(rest_));
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using Cell = typename std::remove_cvref_t<decltype(table)>::element::cell;
      tables_.emplace_back(parts.backend, corners.of[type++], Cell::corners, count_);
      // Grids, which cut simplices anywhere, leave more to smooth; their rows are short.
      if (SimplexCell<Cell> && table.count() > 0)
        smoothing_ = SmoothingPolynomial::of_fourth_kind(degree_on_simplices);
    });
  }
  Array<T> const& rest() const { return rest_; }  // (corners, 4), m

  /// Makes what depends on the matrix, and the first matrix of the grids around the corners. `mask`: see SetMask. The image
  /// and the direction are lost.
  void prepare(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a, Field mask,
               GridLevels<B, dim>& grids, Homes const& homes) {
    auto const& backend = parts.backend;
    backend.for_each(count_,
                     TakeHeldAndMass<T>{node_.data(), held_.data(), mass_.data(),
                                        parts.layout.held.data(), parts.layout.mass.data()});
    matrix_.clear(backend);
    for (int k = 0; k < dim; ++k) {
      set_nodal_column(parts, arrays, a, k);
      add_columns(parts, arrays, a, mask, k, grids, homes);
    }
    InvertDiagonal<T, dim, SlicedView<T, dim>> invert{matrix_.view(), {}};
    for (int k = 0; k < dim; ++k) invert.columns[k] = column(k);
    backend.for_each(count_, invert);
    double const largest = 1.1 * largest_eigenvalue_on(backend, fields(), product(backend));
    per_largest_.upload(std::vector{static_cast<T>(1 / largest)});
  }
  /// x += V-cycle of what b − q is, at a body's unknowns; q is lost.
  void correct(Parts const& parts, SmootherFields<T, dim> const& f,
               SmoothingPolynomial const& smoothing, GridLevels<B, dim> const& grids) const {
    auto const& backend = parts.backend;
    set_sum(backend, f.n, f.q, Scaled<T, dim>{1, {f.b.data}}, Scaled<T, dim>{-1, {f.q.data}});
    auto const own = fields();
    restrict(parts, f.q, own.b);
    cycle_around(backend, own, smoothing_, product(backend),
                 [&] { grids.correct(backend, own, smoothing, mass_.data(), held_.data()); });
    interpolate(parts, {own.x.data}, f.q);
    set_sum(backend, f.n, f.x, Scaled<T, dim>{1, {f.x.data}}, Scaled<T, dim>{1, {f.q.data}});
  }
  Index count() const { return count_; }
  SlicedView<T, dim> matrix() const { return matrix_.view(); }
  /// to = Pᵀ of a field at a body's unknowns, zero elsewhere, that is lost.
  void restrict(Parts const& parts, Field from, Field to) const {
    between_.add_transpose(parts.backend, from);
    take(parts, {from.data}, to);
  }
  /// to = P of a field of corners, at a body's unknowns.
  void interpolate(Parts const& parts, NodeField<T const, dim> from, Field to) const {
    parts.backend.for_each(count_, PutCorners<T, dim>{node_.data(), to, from, held_.data()});
    between_.apply(parts.backend, to);
    keep_unknowns(parts, to);
  }

 private:
  /// The elements of one type.
  struct CornerTable {
    Index elements;
    Array<Index> corner, first, member;
    /// `of`: (elements, corners).
    CornerTable(B const& backend, std::vector<Index> const& of, int corners, Index count)
        : elements(static_cast<Index>(of.size()) / corners) {
      std::vector<Index> columns(of.size());
      auto const n = static_cast<std::size_t>(elements), width = static_cast<std::size_t>(corners);
      for (std::size_t e = 0; e < n; ++e)
        for (std::size_t b = 0; b < width; ++b) columns[n * b + e] = of[width * e + b];
      auto const around = group_by_key(of, count);
      corner = upload(backend, columns);
      first = upload(backend, around.first);
      member = upload(backend, around.order);
    }
    template <int Corners>
    CornerTableView<Corners> view() const {
      return {elements, corner.data(), first.data(), member.data()};
    }
  };

  static Field field(Array<T> const& array) { return {const_cast<T*>(array.data())}; }
  Field column(int k) const {
    return {field(blocks_).data + static_cast<std::ptrdiff_t>(k) * node_stride * count_};
  }
  SmootherFields<T, dim> fields() const {
    SmootherFields<T, dim> f{count_,    field(b_), field(x_),          field(d_),
                             field(q_), {},        per_largest_.data()};
    for (int k = 0; k < dim; ++k) f.columns[k] = {column(k).data};
    return f;
  }
  auto product(B const& backend) const {
    return [&backend, n = count_, a = matrix_.view()](Field from, Field to) {
      backend.for_each(n, SlicedProduct<T, dim>{a, to, {from.data}});
    };
  }
  void take(Parts const& parts, NodeField<T const, dim> from, Field to) const {
    parts.backend.for_each(count_, TakeCorners<T, dim>{node_.data(), to, from, held_.data()});
  }

  /// Into the direction: see SetNodalColumn.
  void set_nodal_column(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a,
                        int k) const {
    auto const work = field(arrays.image);
    clear_rows(parts, work);
    if (a.stiffness + a.damping != 0)
      for_each_added_term(parts, [&](auto const& term) {
        term.add_diagonal(parts.backend, parts.at(a.place), k, work);
      });
    parts.backend.for_each(parts.layout.rows,
                           SetNodalColumn<T, dim>{field(arrays.direction),
                                                  {work.data},
                                                  share_.data(),
                                                  parts.layout.mass.data(),
                                                  static_cast<T>(a.stiffness + a.damping),
                                                  static_cast<T>(a.inertia),
                                                  k});
  }
  /// Of all corners, in direction k.
  void add_columns(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a, Field mask,
                   int k, GridLevels<B, dim>& grids, Homes const& homes) {
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using Table = std::remove_cvref_t<decltype(table)>;
      using E = typename Table::element;
      constexpr int corners = E::cell::corners;
      auto const& home = homes[type];
      auto const view = tables_[type++].template view<corners>();
      if constexpr (E::degree == 2) {
        if (view.elements == 0) return;
        auto memory = zeros<T>(parts.backend, static_cast<std::size_t>(corners * corners * dim) *
                                                  static_cast<std::size_t>(view.elements));
        CornerColumns<T, dim, corners> const columns{memory.data(), view.elements};
        ElementColumn<T, typename Table::Laws, LinearFunctions<E>> column{
            table.laws, {}, 0, k, static_cast<T>(a.stiffness + a.damping), nullptr, view.elements};
        for (int corner = 0; corner < corners; ++corner) {
          column.function = corner;
          column.out = columns.column(corner);
          parts.backend.template visit<Table::groups>(
              table.elements, column, parts.no_counters, parts.rest(), a.place,
              typename Parts::ConstField{mask.data},
              typename Parts::ConstField{arrays.direction.data()});
        }
        parts.backend.for_each(count_,
                               AddCornerColumns<T, dim, corners>{matrix_.view(), view, columns, k});
        auto const& finest = grids.finest();
        parts.backend.for_each(
            finest.nodes, AddBoxColumns<T, dim, corners>{grids.matrix(0), finest, view, columns,
                                                         home.first.data(), home.member.data(), k});
        parts.backend.synchronize();  // before the columns go
      }
    });
  }

  static constexpr int degree_on_simplices = 8;
  SmoothingPolynomial smoothing_ = SmoothingPolynomial::of_fourth_kind();
  Index count_;
  Array<Index> node_;           // of corners
  InterpolationOn<B> between_;  // of the other nodes
  SlicedMatrix<B, dim> matrix_;
  Array<DirectionMask> held_;      // (corners)
  Array<T> per_largest_;           // (1): see SmoothingStep
  Array<T> share_, mass_;          // (nodes): see CornersOfBody; (corners)
  Array<T> rest_, b_, x_, d_, q_;  // (corners, 4)
  Array<T> blocks_;                // (dim, corners, 4): inverses of the matrix's diagonal
  std::vector<CornerTable> tables_;
};

}  // namespace pliant::detail
