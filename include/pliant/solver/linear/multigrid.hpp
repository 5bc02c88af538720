#pragma once

#include <pliant/solver/linear/element_columns.hpp>
#include <pliant/solver/linear/grid_levels.hpp>
#include <pliant/solver/linear/preconditioner.hpp>

namespace pliant::detail {

/// A preconditioner on a body's backend: a polynomial of the matrix, and with grids a symmetric V-cycle around it, whose
/// coarse functions are linear along each axis of a regular grid around the body, whatever its mesh. Positive definite where
/// the matrix is. It stands as long as the body's topology; what it is made from the matrix, as long as that serves.
template <class Parts>
class Multigrid final : public KeptPreconditioner {
  using T = typename Parts::T;
  using B = typename Parts::backend_type;
  static constexpr int dim = Parts::dim;
  static constexpr int corners = power_of(2, dim);
  template <class U>
  using Array = typename Parts::template Array<U>;
  using Arrays = SolverArrays<B>;
  using Grid = BackgroundGrid<dim>;

 public:
  Multigrid(Parts const& parts, Preconditioner kind)
      : kind_(kind),
        polynomial_(kind == Preconditioner::multigrid
                        ? SmoothingPolynomial::of_fourth_kind(smoothing_degree)
                        : SmoothingPolynomial::of_first_kind(degree_alone, ratio_alone)),
        step_(zeros<T>(parts.backend, parts.layout.rest.size())),
        per_largest_(zeros<T>(parts.backend, 1)) {
    if (kind == Preconditioner::multigrid) lay_grids(parts);
  }
  Preconditioner kind() const { return kind_; }
  /// Of matrices, the body's among them.
  int levels() const { return 1 + grids_.count(); }
  GridLevels<B, dim> const& grids() const { return grids_; }

  /// Makes all that depends on the matrix, and arrays.blocks. arrays.solution and residual stay as they are.
  void prepare(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a) {
    a.invert_blocks(parts, arrays.blocks.data(), field(arrays.image));
    if (!grids_.empty()) {
      grids_.clear_finest_matrix(parts.backend);
      add_elements(parts, arrays, a);
      add_nodes(parts, arrays, a);
      grids_.prepare(parts.backend);
    }
    auto fields = fine_fields(parts, arrays);
    fields.b = field(arrays.direction);
    double const largest = 1.1 * largest_eigenvalue_on(parts.backend, fields, product(parts, a));
    per_largest_.upload(std::vector{static_cast<T>(1 / largest)});
  }
  /// arrays.conditioned from arrays.residual. The image is lost.
  void apply(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a) const {
    auto const fields = fine_fields(parts, arrays);
    auto const& backend = parts.backend;
    smooth(backend, fields, polynomial_, Guess::zero, product(parts, a));
    if (grids_.empty()) return;
    a.apply(parts, fields.x, fields.q);
    auto const& grid = grids_.finest();
    backend.for_each(grid.nodes, Restrict<T, dim>{grid, grids_.right_side(), {fields.b.data},
                                                  {fields.q.data}});
    grids_.cycle(backend, polynomial_);
    backend.for_each(fields.n, AddInterpolated<T, dim>{grid,
                                                       fields.x,
                                                       {grids_.correction().data},
                                                       parts.layout.mass.data(),
                                                       parts.layout.held.data()});
    smooth(backend, fields, polynomial_, Guess::given, product(parts, a));
  }

 private:
  /// The elements of one type by the boxes of the finest grid that hold their middles.
  struct Homes {
    Array<T> low;  // (dim, elements): lowest corners of these boxes, m
    Array<Index> first, member;
  };

  static NodeField<T, dim> field(Array<T> const& array) { return {const_cast<T*>(array.data())}; }
  SmootherFields<T, dim> fine_fields(Parts const& parts, Arrays const& arrays) const {
    SmootherFields<T, dim> f{parts.layout.nodes,  field(arrays.residual), field(arrays.conditioned),
                             field(step_),        field(arrays.image),    {},
                             per_largest_.data()};
    for (int k = 0; k < dim; ++k)
      f.columns[k] = {
          ShiftedTangent<Parts>::column(parts, const_cast<T*>(arrays.blocks.data()), k).data};
    return f;
  }
  static auto product(Parts const& parts, ShiftedTangent<Parts> const& a) {
    return [&](NodeField<T, dim> from, NodeField<T, dim> to) { a.apply(parts, from, to); };
  }

  void lay_grids(Parts const& parts) {
    auto const& mesh = parts.state.topology->mesh;
    auto grid = grid_around(mesh);
    auto const relative = [&](Point<dim> x) {
      for (std::size_t k = 0; k < dim; ++k) x[k] -= parts.layout.middle[k];
      return x;
    };
    grid.low = relative(grid.low);
    std::vector<typename Grid::Place> occupied, at_node(mesh.nodes.size());
    std::vector<bool> has_element(mesh.nodes.size(), false);
    std::vector<std::size_t> first_of_table;
    parts.for_each_type([&](auto const& table, auto const&) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      first_of_table.push_back(occupied.size());
      auto const& elements = mesh.template elements<E>();
      for (Index user : table.user_element) {
        auto const& element = elements[static_cast<std::size_t>(user)];
        Point<dim> middle{};
        for (std::size_t a = 0; a < E::cell::corners; ++a)
          for (std::size_t k = 0; k < dim; ++k)
            middle[k] += mesh.nodes[static_cast<std::size_t>(element[a])][k] / E::cell::corners;
        occupied.push_back(grid.place_of(relative(middle)));
        for (Index i : element) {
          at_node[static_cast<std::size_t>(i)] = occupied.back();
          has_element[static_cast<std::size_t>(i)] = true;
        }
      }
    });
    grid.number(occupied);

    std::vector<Index> boxes_of(mesh.nodes.size(), -1);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      if (!has_element[i]) continue;
      Index box = grid.find_box(grid.place_of(relative(mesh.nodes[i])));
      // A node out of all boxes belongs to the one that holds an element of its.
      if (box < 0) box = grid.find_box(at_node[i]);
      boxes_of[static_cast<std::size_t>(parts.layout.internal_of(static_cast<Index>(i)))] = box;
    }
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      auto const from = occupied.begin() + static_cast<std::ptrdiff_t>(first_of_table[type++]);
      homes_.push_back(homes_of(parts, grid, {from, from + table.count()}));
    });
    for (std::size_t k = 0; k < dim; ++k)
      per_spacing_[k] = static_cast<T>(1 / grid.spacing[k]);
    grids_ = {parts.backend, std::move(grid), parts.layout.rest, std::move(boxes_of)};
  }
  static Homes homes_of(Parts const& parts, Grid const& grid,
                        std::vector<typename Grid::Place> const& places) {
    std::vector<Index> boxes(places.size());
    std::vector<T> low(dim * places.size());
    for (std::size_t e = 0; e < places.size(); ++e) {
      boxes[e] = grid.find_box(places[e]);
      auto const corner = grid.point_at(places[e]);
      for (std::size_t k = 0; k < dim; ++k) low[k * places.size() + e] = static_cast<T>(corner[k]);
    }
    auto const by_box = group_by_key(boxes, static_cast<Index>(grid.box.size()));
    return {upload(parts.backend, low), upload(parts.backend, by_box.first),
            upload(parts.backend, by_box.order)};
  }

  void add_elements(Parts const& parts, Arrays& arrays, ShiftedTangent<Parts> const& a) {
    double const factor = a.stiffness + a.damping;
    if (factor == 0) return;
    auto const mask = field(arrays.conditioned);
    parts.backend.for_each(
        parts.layout.nodes,
        SetMask<T, dim>{mask, parts.layout.mass.data(), parts.layout.held.data()});
    parts.layout.interpolation.apply(parts.backend, mask);
    std::size_t type = 0;
    parts.for_each_type([&](auto const& table, auto const&) {
      using Table = std::remove_cvref_t<decltype(table)>;
      auto const& homes = homes_[type++];
      Index const count = table.count();
      if (count == 0) return;
      auto columns = zeros<T>(parts.backend, static_cast<std::size_t>(corners * dim) *
                                                 static_cast<std::size_t>(count));
      ElementColumn<T, dim, typename Table::Laws> column{
          table.laws, {homes.low.data(), count}, {}, 0, 0, static_cast<T>(factor), columns.data(),
          count};
      std::ranges::copy(per_spacing_, column.per_spacing);
      AddElementColumns<T, dim> add{
          grids_.matrix(0), grids_.finest(), homes.first.data(), homes.member.data(), 0, 0,
          columns.data(),   count};
      for (int corner = 0; corner < corners; ++corner)
        for (int k = 0; k < dim; ++k) {
          column.corner = add.corner = corner;
          column.direction = add.direction = k;
          parts.backend.template visit<Table::groups>(
              table.elements, column, parts.no_counters, parts.rest(), a.place,
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
        set_sum(parts.backend, parts.layout.nodes, column, Scaled<T, dim>{1, {work.data}});
      }
    }
    parts.backend.for_each(add.grid.nodes, add);
    parts.backend.synchronize();
  }

  static constexpr int smoothing_degree = 2, degree_alone = 4;
  static constexpr double ratio_alone = 30;
  Preconditioner kind_;
  SmoothingPolynomial polynomial_;
  Array<T> step_, per_largest_;  // of the polynomial
  GridLevels<B, dim> grids_;     // none: the polynomial alone
  std::vector<Homes> homes_;     // of each element type
  std::array<T, dim> per_spacing_{};  // of the finest grid, 1/m
};

}  // namespace pliant::detail
