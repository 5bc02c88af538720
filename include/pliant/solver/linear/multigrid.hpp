#pragma once

#include <optional>
#include <type_traits>

#include <pliant/solver/linear/corner_level.hpp>
#include <pliant/solver/linear/element_columns.hpp>
#include <pliant/solver/linear/grid_levels.hpp>
#include <pliant/solver/linear/grid_of_body.hpp>
#include <pliant/solver/linear/preconditioner.hpp>

namespace pliant::detail {

/// A preconditioner on a body's backend: a polynomial of the matrix, and with grids a symmetric V-cycle around it, whose
/// coarse functions are linear along each axis of a regular grid around the body, whatever its mesh; between quadratic
/// elements and these, if asked for, linear elements on the same cells. Positive definite where the matrix is. It stands as long as the body's topology; what it is made from the matrix, as long as that serves.
template <class Parts>
class Multigrid final : public KeptBySolver {
  using T = typename Parts::T;
  using B = typename Parts::backend_type;
  static constexpr int dim = Parts::dim;
  static constexpr int corners = power(2, dim);
  template <class U>
  using Array = typename Parts::template Array<U>;
  using Arrays = SolverArrays<B>;
  static constexpr bool can_be_quadratic = []<Element... Es>(std::type_identity<Mesh<Es...>>) {
    return ((Es::degree == 2) || ...);
  }(std::type_identity<typename Parts::mesh_type>{});

 public:
  /// p_multigrid: only where is_quadratic(parts).
  Multigrid(Parts const& parts, Preconditioner kind)
      : kind_(kind),
        polynomial_(kind == Preconditioner::chebyshev
                        ? SmoothingPolynomial::of_first_kind(degree_alone, ratio_alone)
                        : SmoothingPolynomial::of_fourth_kind()),
        step_(zeros<T>(parts.backend, parts.layout.rest.size())),
        per_largest_(zeros<T>(parts.backend, 1)) {
    if (kind == Preconditioner::chebyshev) return;
    auto found = grid_of_body<Parts>(
        parts, kind == Preconditioner::p_multigrid ? GridFor::corners : GridFor::nodes);
    for (auto const& boxes : found.boxes_of_elements)
      homes_.emplace_back(parts.backend, found.grid, boxes);
    for (std::size_t k = 0; k < dim; ++k)
      per_spacing_[k] = static_cast<T>(1 / found.grid.spacing[k]);
    if constexpr (can_be_quadratic)
      if (kind == Preconditioner::p_multigrid) {
        CornersOfBody const of_body(parts);
        corners_.emplace(parts, of_body);
        std::vector<Index> boxes;
        for (Index node : of_body.node)
          boxes.push_back(found.boxes_of_nodes[static_cast<std::size_t>(node)]);
        grids_ = {parts.backend, std::move(found.grid), corners_->rest(), std::move(boxes)};
        return;
      }
    grids_ = {parts.backend, std::move(found.grid), parts.layout.rest,
              std::move(found.boxes_of_nodes)};
  }
  Preconditioner kind() const { return kind_; }
  /// Of matrices, the body's among them.
  int levels() const { return 1 + (corners_.has_value() ? 1 : 0) + grids_.count(); }
  GridLevels<B, dim> const& grids() const { return grids_; }
  /// Only of p_multigrid.
  auto const& corner_level() const { return *corners_; }

  /// Makes all that depends on the matrix, and arrays.blocks. arrays.solution and residual stay as they are.
  void prepare(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a) {
    a.invert_blocks(parts, arrays.blocks.data(), field(arrays.image));
    if (!grids_.empty()) {
      grids_.clear_finest_matrix(parts.backend);
      auto const mask = field(arrays.conditioned);
      parts.backend.for_each(parts.layout.rows, SetMask<T, dim>{mask, parts.layout.mass.data(),
                                                                parts.layout.held.data()});
      parts.layout.interpolation.apply(parts.backend, mask);
      if constexpr (can_be_quadratic)
        if (corners_) corners_->prepare(parts, arrays, a, mask, grids_, homes_);
      if (!corners_) {
        add_elements(parts, a, mask);
        add_nodes(parts, arrays, a);
      }
      grids_.prepare(parts.backend);
    }
    auto fields = fine_fields(parts, arrays);
    fields.b = field(arrays.direction);
    double const largest = 1.1 * largest_eigenvalue_on(parts.backend, fields, product(parts, a));
    per_largest_.upload(std::vector{static_cast<T>(1 / largest)});
  }
  /// arrays.conditioned from r. The image is lost.
  void apply(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a,
             NodeField<T, dim> r) const {
    auto fields = fine_fields(parts, arrays);
    fields.b = r;
    auto const& backend = parts.backend;
    if (grids_.empty()) {
      smooth(backend, fields, polynomial_, Guess::zero, product(parts, a));
      return;
    }
    cycle_around(backend, fields, polynomial_, product(parts, a), [&] {
      if constexpr (can_be_quadratic)
        if (corners_) return corners_->correct(parts, fields, polynomial_, grids_);
      grids_.correct(backend, fields, polynomial_, parts.layout.mass.data(),
                     parts.layout.held.data());
    });
  }

 private:
  static NodeField<T, dim> field(Array<T> const& array) { return {const_cast<T*>(array.data())}; }
  SmootherFields<T, dim> fine_fields(Parts const& parts, Arrays const& arrays) const {
    SmootherFields<T, dim> f{parts.layout.rows,  field(arrays.residual), field(arrays.conditioned),
                             field(step_),       field(arrays.image),    {},
                             per_largest_.data()};
    for (int k = 0; k < dim; ++k)
      f.columns[k] = {
          ShiftedTangent<Parts>::column(parts, const_cast<T*>(arrays.blocks.data()), k).data};
    return f;
  }
  static auto product(Parts const& parts, ShiftedTangent<Parts> const& a) {
    return [&](NodeField<T, dim> from, NodeField<T, dim> to) { a.apply(parts, from, to); };
  }

  void add_elements(Parts const& parts, ShiftedTangent<Parts> const& a, NodeField<T, dim> mask) {
    double const factor = a.stiffness + a.damping;
    if (factor == 0) return;
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using Table = std::remove_cvref_t<decltype(table)>;
      auto const& homes = homes_[type++];
      Index const count = table.count();
      if (count == 0) return;
      auto columns = zeros<T>(
          parts.backend, static_cast<std::size_t>(corners * dim) * static_cast<std::size_t>(count));
      ElementColumn<T, typename Table::Laws, BoxFunctions<T, dim>> column{
          table.laws, {{homes.low.data(), count}, {}}, 0, 0, static_cast<T>(factor), columns.data(),
          count};
      std::ranges::copy(per_spacing_, column.functions.per_spacing);
      AddElementColumns<T, dim> add{grids_.matrix(0),
                                    grids_.finest(),
                                    homes.first.data(),
                                    homes.member.data(),
                                    0,
                                    0,
                                    columns.data(),
                                    count};
      for (int corner = 0; corner < corners; ++corner)
        for (int k = 0; k < dim; ++k) {
          column.function = add.corner = corner;
          column.direction = add.direction = k;
          parts.backend.template visit<Table::groups>(table.elements, column, parts.no_counters,
                                                      parts.rest(), a.place,
                                                      typename Parts::ConstField{mask.data});
          parts.backend.for_each(add.grid.nodes, add);
        }
      parts.backend.synchronize();  // before the columns go
    });
  }
  /// Masses, as lumped ones, and the diagonal of the added force terms: what they couple is not looked at.
  void add_nodes(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a) {
    double const stiffness = a.stiffness + a.damping;
    bool const terms = stiffness != 0 && !(parts.terms.empty() && parts.pressures.empty());
    if (a.inertia == 0 && !terms) return;
    AddNodalBlocks<T, dim> add{grids_.matrix(0),
                               grids_.finest(),
                               parts.layout.mass.data(),
                               parts.layout.held.data(),
                               static_cast<T>(a.inertia),
                               static_cast<T>(stiffness),
                               {}};
    Array<T> blocks;
    if (terms) {
      blocks = zeros<T>(parts.backend, dim * parts.layout.rest.size());
      auto const work = field(arrays.image);
      for (int k = 0; k < dim; ++k) {
        auto const column = ShiftedTangent<Parts>::column(parts, blocks.data(), k);
        add.columns[k] = {column.data};
        clear_rows(parts, work);
        for_each_added_term(parts, [&](auto const& term) {
          term.add_diagonal(parts.backend, parts.at(a.place), k, work);
        });
        parts.layout.interpolation.hand_on_magnitudes(parts.backend, work);
        set_sum(parts.backend, parts.layout.rows, column, Scaled<T, dim>{1, {work.data}});
      }
    }
    parts.backend.for_each(add.grid.nodes, add);
    parts.backend.synchronize();
  }

  static constexpr int degree_alone = 4;
  static constexpr double ratio_alone = 30;
  Preconditioner kind_;
  SmoothingPolynomial polynomial_;
  Array<T> step_, per_largest_;  // of the polynomial
  struct None {};
  std::optional<std::conditional_t<can_be_quadratic, CornerLevel<Parts>, None>> corners_;
  GridLevels<B, dim> grids_;                 // none: the polynomial alone
  std::vector<ElementHomes<B, dim>> homes_;  // of each element type
  std::array<T, dim> per_spacing_{};         // of the finest grid, 1/m
};

}  // namespace pliant::detail
