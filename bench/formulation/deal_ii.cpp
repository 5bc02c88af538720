#include <deal.II/base/config.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

// Debian's deal.II is built for processors without vectors. Its templates are compiled anew here, for the vectors of
// this one.
#undef DEAL_II_VECTORIZATION_WIDTH_IN_BITS
#undef DEAL_II_COMPILER_VECTORIZATION_LEVEL
#if defined(__AVX512F__)
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 512
#define DEAL_II_COMPILER_VECTORIZATION_LEVEL 3
#elif defined(__AVX__)
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 256
#define DEAL_II_COMPILER_VECTORIZATION_LEVEL 2
#else
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 128
#define DEAL_II_COMPILER_VECTORIZATION_LEVEL 1
#endif

#include <deal.II/base/mpi.h>
#include <deal.II/base/multithread_info.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_simplex_p.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping_fe.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/matrix_free/evaluation_template_factory.templates.h>
#include <deal.II/matrix_free/evaluation_template_factory_hanging_nodes.templates.h>
#include <deal.II/matrix_free/fe_evaluation.h>
#include <deal.II/matrix_free/util.h>

// For points inside tetrahedra deal.II 9.4 wants points on sides too, and has none for the rule of four. No loop here
// visits sides.
namespace dealii::internal::MatrixFreeFunctions {
template <>
inline std::pair<dealii::ReferenceCell, dealii::hp::QCollection<2>>
get_face_quadrature_collection<3>(Quadrature<3> const& points, bool) {
  if (points.size() <= 4)
    return {ReferenceCells::Tetrahedron, dealii::hp::QCollection<2>(QGaussSimplex<2>(1))};
  return {ReferenceCells::Hexahedron,
          dealii::hp::QCollection<2>(QGauss<2>(points.size() == 8 ? 2 : 3))};
}
template <>
inline std::pair<Quadrature<2>, Quadrature<2>> get_unique_face_quadratures<3>(
    Quadrature<3> const& points) {
  auto const [cell, on_sides] = get_face_quadrature_collection(points);
  if (cell == ReferenceCells::Tetrahedron) return {Quadrature<2>(), on_sides[0]};
  return {on_sides[0], Quadrature<2>()};
}
}  // namespace dealii::internal::MatrixFreeFunctions

#include <deal.II/matrix_free/mapping_info.templates.h>
#include <deal.II/matrix_free/mapping_info_storage.templates.h>
#include <deal.II/matrix_free/matrix_free.templates.h>
#include <deal.II/matrix_free/shape_info.templates.h>
// Two headers of deal.II 9.4 have the same guard.
#undef dealii_matrix_free_evaluation_template_factory_templates_h
#include <deal.II/matrix_free/evaluation_template_face_factory.templates.h>

#include "deal_ii.hpp"
#include "deal_ii_laws.hpp"

// Forces and tangent products by deal.II's MatrixFree, in its own way: metric terms and, for tangents, displacement
// gradients are stored per point; cells are in the order of the mesh that is handed over, unknowns in that of its nodes.
namespace pliant::bench {
namespace {

using Rows = std::vector<std::array<double, 3>>;
using Values = dealii::LinearAlgebra::distributed::Vector<double>;
using CellIterator = dealii::Triangulation<3>::cell_iterator;

/// The map of each cell through the places of all its nodes, in the order of a finite element.
class MappingOfNodes : public dealii::MappingFE<3> {
 public:
  using Places = std::vector<std::vector<dealii::Point<3>>>;
  MappingOfNodes(dealii::FiniteElement<3> const& element, std::shared_ptr<Places const> places)
      : MappingFE(element), element_(element.clone()), places_(std::move(places)) {}
  std::unique_ptr<dealii::Mapping<3>> clone() const override {
    return std::make_unique<MappingOfNodes>(*element_, places_);
  }

 private:
  std::vector<dealii::Point<3>> compute_mapping_support_points(
      CellIterator const& cell) const override {
    return (*places_)[static_cast<std::size_t>(cell->index())];
  }
  std::unique_ptr<dealii::FiniteElement<3>> element_;
  std::shared_ptr<Places const> places_;
};

/// Degree −1: deal.II's evaluation for elements that are no tensor products.
template <int Degree, int Points>
class DealII : public Peer {
  using MatrixFree = dealii::MatrixFree<3, double, Lanes>;
  using Evaluation = dealii::FEEvaluation<3, Degree, Points, 3, double, Lanes>;
  static constexpr auto gradients = dealii::EvaluationFlags::gradients;

 public:
  DealII(PeerMesh const& mesh, dealii::FiniteElement<3> const& element,
         dealii::Quadrature<3> const& quadrature)
      : svk_{mesh.lambda, mesh.mu}, nh_{mesh.lambda, mesh.mu}, system_(element, 3) {
    auto const in_mesh = nodes_by_support_point(mesh, element);
    make_cells(mesh);
    auto const places = std::make_shared<MappingOfNodes::Places>();
    for (std::size_t e = 0; e < mesh.elements.size(); e += in_mesh.size()) {
      auto& own = places->emplace_back();
      for (int a : in_mesh) {
        auto const& x = mesh.nodes[static_cast<std::size_t>(mesh.elements[e + a])];
        own.emplace_back(x[0], x[1], x[2]);
      }
    }
    dofs_.reinit(cells_);
    dofs_.distribute_dofs(system_);
    renumber(mesh, in_mesh);
    dealii::AffineConstraints<double> none;
    none.close();
    typename MatrixFree::AdditionalData data;
    data.tasks_parallel_scheme = MatrixFree::AdditionalData::none;
    data.mapping_update_flags = dealii::update_gradients | dealii::update_JxW_values;
    matrix_free_.reinit(MappingOfNodes(element, places), dofs_, none, quadrature, data);
    for (Values* v : {&u_, &du_, &result_}) matrix_free_.initialize_dof_vector(*v);
  }

  std::string name() const override {
    std::string const bits = std::to_string(DEAL_II_VECTORIZATION_WIDTH_IN_BITS);
#if defined(__clang__)
    return "deal.II " DEAL_II_PACKAGE_VERSION " at " + bits + " bits, clang++ " +
           std::to_string(__clang_major__);
#else
    return "deal.II " DEAL_II_PACKAGE_VERSION " at " + bits + " bits, g++ " +
           std::to_string(__GNUC__);
#endif
  }
  void set_displacements(Rows const& u, Rows const& du) override {
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        u_(static_cast<unsigned>(3 * i + k)) = u[i][k];
        du_(static_cast<unsigned>(3 * i + k)) = du[i][k];
      }
    Evaluation phi(matrix_free_);
    points_ = phi.n_q_points;
    stored_.resize_fast(std::size_t{matrix_free_.n_cell_batches()} * points_);
    for (unsigned cell = 0; cell < matrix_free_.n_cell_batches(); ++cell) {
      phi.reinit(cell);
      phi.gather_evaluate(u_, gradients);
      for (unsigned q = 0; q < points_; ++q)
        stored_[std::size_t{cell} * points_ + q] = phi.get_gradient(q);
    }
  }
  void force(PeerLaw law) override {
    with(law, [this](auto const& physics) {
      loop(u_, [&](unsigned, Gradient const& h) { return physics.stress(h); });
    });
  }
  void tangent_product(PeerLaw law) override {
    with(law, [this](auto const& physics) {
      loop(du_, [&](std::size_t point, Gradient const& dh) {
        return physics.derivative(stored_[point], dh);
      });
    });
  }
  Rows result() const override {
    Rows rows(result_.locally_owned_size() / 3);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) rows[i][k] = -result_(static_cast<unsigned>(3 * i + k));
    return rows;
  }

 private:
  template <class Visit>
  void with(PeerLaw law, Visit const& visit) {
    law == PeerLaw::neo_hookean ? visit(nh_) : visit(svk_);
  }
  template <class Stress>
  void loop(Values const& in, Stress const& stress) {
    matrix_free_.template cell_loop<Values, Values>(
        [&](MatrixFree const& data, Values& out, Values const& from,
            std::pair<unsigned, unsigned> const& range) {
          Evaluation phi(data);
          unsigned const points = phi.n_q_points;
          for (unsigned cell = range.first; cell < range.second; ++cell) {
            phi.reinit(cell);
            phi.gather_evaluate(from, gradients);
            for (unsigned q = 0; q < points; ++q)
              phi.submit_gradient(stress(std::size_t{cell} * points + q, phi.get_gradient(q)), q);
            phi.integrate_scatter(gradients, out);
          }
        },
        result_, in, true);
  }

  /// By the support point of a finite element: the place in an element of the mesh.
  static std::vector<int> nodes_by_support_point(PeerMesh const& mesh,
                                                 dealii::FiniteElement<3> const& element) {
    std::vector<int> nodes;
    for (auto const& point : element.get_unit_support_points())
      for (std::size_t a = 0; a < mesh.places.size(); ++a) {
        auto const& x = mesh.places[a];
        if (point.distance(dealii::Point<3>(x[0], x[1], x[2])) < 1e-9)
          nodes.push_back(static_cast<int>(a));
      }
    AssertThrow(nodes.size() == mesh.places.size(),
                dealii::ExcMessage("the nodes of an element are not deal.II's"));
    return nodes;
  }
  void make_cells(PeerMesh const& mesh) {
    auto const type =
        mesh.simplex ? dealii::ReferenceCells::Tetrahedron : dealii::ReferenceCells::Hexahedron;
    std::vector<int> corner(type.n_vertices(), -1);
    for (unsigned v = 0; v < corner.size(); ++v)
      for (std::size_t a = 0; a < mesh.places.size(); ++a) {
        auto const& x = mesh.places[a];
        if (type.template vertex<3>(v).distance(dealii::Point<3>(x[0], x[1], x[2])) < 1e-9)
          corner[v] = static_cast<int>(a);
      }
    std::vector<int> vertex(mesh.nodes.size(), -1);
    std::vector<dealii::Point<3>> vertices;
    std::vector<dealii::CellData<3>> cells;
    for (std::size_t e = 0; e < mesh.elements.size(); e += mesh.places.size()) {
      auto& cell = cells.emplace_back(static_cast<unsigned>(corner.size()));
      for (std::size_t v = 0; v < corner.size(); ++v) {
        auto const node = static_cast<std::size_t>(mesh.elements[e + corner[v]]);
        if (vertex[node] < 0) {
          vertex[node] = static_cast<int>(vertices.size());
          vertices.emplace_back(mesh.nodes[node][0], mesh.nodes[node][1], mesh.nodes[node][2]);
        }
        cell.vertices[v] = static_cast<unsigned>(vertex[node]);
      }
    }
    cells_.create_triangulation(vertices, cells, {});
  }
  /// Unknown 3 i + k is direction k of node i: as the elements meet them first.
  void renumber(PeerMesh const& mesh, std::vector<int> const& in_mesh) {
    auto const unknown = dealii::numbers::invalid_dof_index;
    std::vector<dealii::types::global_dof_index> own(system_.n_dofs_per_cell()),
        numbers(dofs_.n_dofs(), unknown);
    for (auto const& cell : dofs_.active_cell_iterators()) {
      cell->get_dof_indices(own);
      for (unsigned i = 0; i < own.size(); ++i) {
        auto const [k, a] = system_.system_to_component_index(i);
        auto const node = mesh.elements[cell->index() * in_mesh.size() + in_mesh[a]];
        auto const number = static_cast<dealii::types::global_dof_index>(3 * node) + k;
        AssertThrow(numbers[own[i]] == unknown || numbers[own[i]] == number,
                    dealii::ExcMessage("an unknown of deal.II belongs to two nodes"));
        numbers[own[i]] = number;
      }
    }
    dofs_.renumber_dofs(numbers);
  }

  PeerSaintVenantKirchhoff svk_;
  PeerNeoHookean nh_;
  dealii::FESystem<3> system_;
  dealii::Triangulation<3> cells_;
  dealii::DoFHandler<3> dofs_;
  MatrixFree matrix_free_;
  Values u_, du_, result_;
  unsigned points_ = 0;
  dealii::AlignedVector<Gradient> stored_;  // (batches of cells, points)
};

}  // namespace
}  // namespace pliant::bench

extern "C" __attribute__((visibility("default"))) pliant::bench::Peer* pliant_bench_make_peer(
    pliant::bench::PeerMesh const& mesh) {
  using namespace pliant::bench;
  dealii::MultithreadInfo::set_thread_limit(1);
  if (mesh.simplex) {
    // One point, or four: exact to degree 1, 2.
    dealii::QWitherdenVincentSimplex<3> const points(1, mesh.degree == 1);
    return new DealII<-1, 0>(mesh, dealii::FE_SimplexP<3>(static_cast<unsigned>(mesh.degree)),
                             points);
  }
  dealii::QGauss<3> const points(static_cast<unsigned>(mesh.degree + 1));
  dealii::FE_Q<3> const element(static_cast<unsigned>(mesh.degree));
  if (mesh.degree == 1) return new DealII<1, 2>(mesh, element, points);
  return new DealII<2, 3>(mesh, element, points);
}
