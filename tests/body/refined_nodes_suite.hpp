#pragma once

#include <memory>
#include <optional>

#include <pliant/body/family_momentum_on.hpp>
#include <pliant/body/fill_new_nodes_on.hpp>
#include <pliant/body/node_rows_on.hpp>
#include <pliant/topology/hanging_nodes_on.hpp>
#include <pliant/topology/plan.hpp>

#include "body/changed_nodes.hpp"
#include "support/formulations.hpp"
#include "topology/trees_on.hpp"

// What belongs to the nodes of a mesh that is refined in a backend's memory, beside what the host makes of it.
namespace pliant::test::refined_nodes_suite {

using namespace changed_nodes;

/// Whether the host may fuse products with sums, as it does function by function.
#if defined(__FMA__) || defined(__FP_FAST_FMA) || defined(__aarch64__)
inline constexpr bool host_fuses = true;
#else
inline constexpr bool host_fuses = false;
#endif
/// The same mass; where masters have shares of slaves by weights that are no powers of two, and the host's sums of these have other
/// roundings, one beside it.
template <Element E>
bool same(double a, double b) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  if constexpr (E::degree == 1 || !host_fuses) return a == b;
  return std::abs(a - b) <= 8 * epsilon * (std::abs(a) + std::abs(b));
}

/// A mesh that is refined on the host and in a backend's memory, with fields at its nodes.
template <Element E, class B>
struct RefinedNodes {
  using M = Mesh<E>;
  using T = typename B::scalar;
  static constexpr int dim = E::dim;
  using Field = std::vector<Point<dim>>;
  template <class U>
  using Array = typename B::template Array<U>;

  B backend;
  std::shared_ptr<Topology<M> const> host;
  Numbering<E> numbering;
  TreeOn<B> tree;
  LeafOrderOn<B> order;
  NodeRowsOn<B> rows;
  HangingNodesOn<dim, B> hanging;
  std::unique_ptr<InterpolationOn<B>> slaves = std::make_unique<InterpolationOn<B>>();
  NodalMassesOn<B> masses;
  FamilyMomentumOn<E::dim, B> momentum;
  Array<double> points, kilograms;
  Array<T> v, mass;
  Array<DirectionMask> held;
  std::vector<Point<dim>> points_on_host;
  std::vector<DirectionMask> held_by_user;

  RefinedNodes(B const& on, M const& mesh)
      : RefinedNodes(on, mesh, std::make_shared<Topology<M>>(mesh), Hierarchy<dim>(mesh)) {}

  /// Values by the row; zero where no node has it.
  template <class U, class Value>
  std::vector<U> by_row(std::size_t width, Value const& value) const {
    auto const row_of = rows.download_all().of_node;
    std::vector<U> values(width * at(rows.count()));
    for (std::size_t node = 0; node < row_of.size(); ++node)
      for (std::size_t k = 0; k < width; ++k)
        values[width * at(row_of[node]) + k] = static_cast<U>(value(node, k));
    return values;
  }
  template <class U, class A>
  std::vector<U> by_user(A const& array, std::size_t stride, std::size_t k = 0) const {
    auto const row_of = rows.download_all().of_node;
    auto const values = download<U>(array);
    std::vector<U> own(row_of.size());
    for (std::size_t node = 0; node < own.size(); ++node)
      own[node] = values[stride * at(row_of[node]) + k];
    return own;
  }
  template <class U>
  auto padded(Field const& field) const {
    return upload(backend, by_row<U>(node_stride, [&](std::size_t node, std::size_t k) {
                    return k < dim ? field[node][k] : 0.0;
                  }));
  }
  template <class U, class A>
  Field field_of(A const& array) const {
    Field field(at(rows.nodes()));
    for (std::size_t k = 0; k < dim; ++k) {
      auto const own = by_user<U>(array, node_stride, k);
      for (std::size_t i = 0; i < field.size(); ++i) field[i][k] = static_cast<double>(own[i]);
    }
    return field;
  }
  /// Those of slaves as they are given.
  void set_velocities(Field const& field) { v = padded<T>(field); }
  void hold(std::vector<DirectionMask> const& by_node) {
    held_by_user = by_node;
    held = upload(backend, by_row<DirectionMask>(
                               1, [&](std::size_t node, std::size_t) { return by_node[node]; }));
  }

  std::optional<TopologyPlan<M>> plan(std::vector<Index> const& elements) const {
    return plan_change(host, {.refine = {elements}}, {}, {},
                       {.widths = {0}, .places = {{{}}}, .set_by_place = {{}}});
  }
  /// The same refinement in the backend's memory; returns what held nodes took. disturb(velocities) may change those of new
  /// nodes that the refinement gave them.
  template <class Disturb>
  Point<dim> refine(std::vector<Index> const& elements, Disturb const& disturb) {
    std::vector<Index> cells = elements;
    if (host->tree)
      for (Index& e : cells) e = host->cells[0][at(e)];
    auto const marked = upload(backend, cells);
    auto const rows_before = at(rows.count());
    auto const refined = tree.refine(marked.data(), static_cast<Index>(cells.size()));
    order.refine(tree, refined);
    rows.extend(tree, order, refined);
    tree.keep();
    auto const now = at(rows.count());
    detail::grow_keeping(backend, points, node_stride * rows_before, node_stride * now);
    detail::grow_keeping(backend, v, node_stride * rows_before, node_stride * now);
    detail::grow_keeping(backend, held, rows_before, now);
    detail::grow(backend, kilograms, now);
    detail::grow(backend, mass, now);
    Index const* const of_node = rows.of_node();
    filling_new_nodes<E>(tree, refined, false, of_node, node_field<dim>(points), node_field<dim>(v))
        .run(backend);
    auto disturbed = field_of<T>(v);
    disturb(disturbed);
    v = padded<T>(disturbed);
    auto next = std::make_unique<InterpolationOn<B>>(backend, hanging.rows(tree, of_node));
    MassWeightsOn<B> const before_weights(backend, *slaves, rows.count()),
        weights(backend, *next, rows.count());
    auto const elements_now = detail::refined_elements<E>(
        tree, refined, of_node, NodeField<double const, dim>{points.data(), rows.count()});
    masses.extend(rows.count());
    momentum.begin(before_weights, weights, masses, elements_now);
    masses.read(weights, kilograms.data());
    masses.round(kilograms.data(), mass.data());
    momentum.give_back(before_weights, weights, density, 64 * density, kilograms.data(),
                       held.data(), node_field<dim>(v), elements_now);
    backend.synchronize();
    slaves = std::move(next);
    masses.template check<T>();
    return momentum.taken();
  }

 private:
  RefinedNodes(B const& on, M const& mesh, std::shared_ptr<Topology<M> const> topology,
               Hierarchy<dim> const& hierarchy)
      : backend(on),
        host(std::move(topology)),
        numbering(mesh),
        tree(backend, hierarchy.tree().lists(), *hierarchy.tree().cells_at_edges()),
        order(backend, first_order(numbering)),
        rows(backend, NodeRows{numbering.internal_node, numbering.user_node, {}}),
        hanging(backend),
        masses(backend, {}, detail::unit_of_masses(density, 1), density),
        momentum(backend),
        points_on_host(mesh.nodes) {
    auto const first = masses_on_host(*host);
    std::vector<detail::ExactSum> own(at(rows.count()));
    auto const row_of = rows.download_all().of_node;
    for (std::size_t i = 0; i < row_of.size(); ++i) own[at(row_of[i])] = first.own[i];
    masses = {backend, own, first.mass_unit, density};
    points = padded<double>(mesh.nodes);
    hold(std::vector<DirectionMask>(mesh.nodes.size(), 0));
  }
};

template <class B, Element E>
void check_rounds(B const& backend, Mesh<E> const& mesh, std::size_t one_in, int rounds) {
  using T = typename B::scalar;
  using M = Mesh<E>;
  constexpr std::size_t dim = E::dim;
  double const epsilon{std::numeric_limits<T>::epsilon()};
  RefinedNodes<E, B> nodes(backend, mesh);
  Random random(3);
  int hung = 0;
  for (int round = 0; round < rounds; ++round) {
    auto const count = nodes.host->nodes();
    std::vector<DirectionMask> held(at(count));
    for (auto& mask : held)
      mask = static_cast<DirectionMask>(random.below(8) == 0 ? random.below(1u << dim) : 0);
    nodes.hold(held);
    nodes.set_velocities(random.field<dim>(at(count), 1));
    std::vector<Index> marked;
    for (std::size_t e = 0; e < nodes.host->counts()[0]; ++e)
      if (random.below(one_in) == 0) marked.push_back(static_cast<Index>(e));
    auto const plan = nodes.plan(marked);
    REQUIRE(plan.has_value());
    auto const given = nodes.template field_of<T>(nodes.v);
    auto const before = masses_on_host(*plan->before), after = masses_on_host(*plan->after);

    std::vector<Point<dim>> filled, disturbed;
    auto const taken = nodes.refine(marked, [&](std::vector<Point<dim>>& field) {
      filled = field;
      auto const other = random.field<dim>(field.size(), 1);
      for (std::size_t i = at(count); i < field.size(); ++i)
        for (std::size_t k = 0; k < dim; ++k)
          field[i][k] = static_cast<double>(static_cast<T>(field[i][k] + other[i][k]));
      disturbed = field;
    });
    nodes.host = plan->after;
    REQUIRE(nodes.rows.nodes() == plan->after->nodes());

    // Points and masses.
    auto const points = nodes.template field_of<double>(nodes.points);
    int wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        wrong += points[i][k] != plan->after->point(static_cast<Index>(i))[k];
    CHECK(wrong == 0);
    auto own = zeros<detail::ExactSum>(backend, at(nodes.rows.count()));
    detail::copy_values(backend, nodes.masses.own(), own.data(), own.size());
    auto const sums = nodes.template by_user<detail::ExactSum>(own, 1);
    auto const kilograms = nodes.template by_user<double>(nodes.kilograms, 1);
    auto const rounded = nodes.template by_user<T>(nodes.mass, 1);
    CHECK(sums == after.own);
    for (std::size_t i = 0; i < kilograms.size(); ++i) {
      wrong += !same<E>(kilograms[i], after.kilograms[i]);
      wrong += rounded[i] != static_cast<T>(kilograms[i]);
    }
    CHECK(wrong == 0);

    // Velocities, as the host gives them.
    auto const old_nodes = all_nodes(count), new_nodes = all_nodes(plan->after->nodes());
    auto v_before = at_all<dim>(old_nodes, given);
    detail::ValuesAt<Point<dim>> v(new_nodes);
    std::ranges::copy(given, v.values.begin());
    plan->transfer.fill_new_nodes(v);
    for (std::size_t i = 0; i < filled.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        wrong += filled[i][k] != static_cast<double>(static_cast<T>(v.values[i][k]));
    CHECK(wrong == 0);
    v.values = disturbed;
    detail::TouchedElements<M> const touched(*plan->before, *plan->after, plan->transfer,
                                             [](auto const&) { return NoneStays{}; });
    held.resize(v.values.size(), 0);
    auto const wanted_taken =
        detail::give_momentum_back(*plan, touched, density, after, held, std::move(v_before), v);
    auto const found = nodes.template field_of<T>(nodes.v);
    double most = 0, changed = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k) {
        most = std::max(most, std::abs(found[i][k] - v.values[i][k]));
        changed = std::max(changed, std::abs(v.values[i][k] - disturbed[i][k]));
      }
    CHECK(most <= 8 * epsilon);
    CHECK(changed > 0.01);
    auto const p_before = momentum_of<dim>(before.kilograms, given);
    auto const p = momentum_of<dim>(after.kilograms, found);
    for (std::size_t k = 0; k < dim; ++k) {
      CHECK(taken[k] == Approx(wanted_taken[k]).margin(32 * epsilon));
      CHECK(std::abs(taken[k]) > 1e-6);
      CHECK(p[k] + taken[k] == Approx(p_before[k]).margin(32 * epsilon));
    }
    hung += static_cast<int>(plan->after->interpolation.slaves().size());
  }
  CHECK(hung > 0);
}

template <class B, Element E>
void check_moving_as_one(B const& backend, Mesh<E> const& mesh, std::size_t one_in, int rounds) {
  using T = typename B::scalar;
  constexpr std::size_t dim = E::dim;
  RefinedNodes<E, B> nodes(backend, mesh);
  Random random(4);
  Point<dim> velocity{};
  for (double& x : velocity) x = static_cast<double>(static_cast<T>(random()));
  nodes.set_velocities(std::vector<Point<dim>>(mesh.nodes.size(), velocity));
  for (int round = 0; round < rounds; ++round) {
    std::vector<Index> marked;
    for (std::size_t e = 0; e < nodes.host->counts()[0]; ++e)
      if (random.below(one_in) == 0) marked.push_back(static_cast<Index>(e));
    auto const plan = nodes.plan(marked);
    REQUIRE(plan.has_value());
    CHECK(nodes.refine(marked, [](auto const&) {}) == Point<dim>{});
    nodes.host = plan->after;
    int wrong = 0;
    for (auto const& v : nodes.template field_of<T>(nodes.v)) wrong += v != velocity;
    CHECK(wrong == 0);
  }
}

/// Calls check(mesh, one in how many elements is refined, rounds).
template <class B, class Check>
void on_meshes(Check const& check) {
  check(shaken(regular_mesh<Tri3>(12), 0.01), 6, 4);
  check(shaken(regular_mesh<Tet4>(4), 0.03), 8, 3);
  if constexpr (!runs_all<B>) return;
  check(shaken(regular_mesh<Quad4>(12), 0.01), 6, 4);
  check(shaken(regular_mesh<Hex8>(4), 0.03), 8, 3);
  check(mesh::raised<Tet10>(shaken(regular_mesh<Tet4>(3), 0.03)), 8, 2);
}

TEST_CASE("nodes of refined meshes have the places, masses and velocities that the host gives them",
          "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_meshes<B>([&](auto const& mesh, std::size_t one_in, int rounds) {
      check_rounds(backend, mesh, one_in, rounds);
    });
  });
}

TEST_CASE("where all nodes move as one, refinement keeps every bit of velocities", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_meshes<B>([&](auto const& mesh, std::size_t one_in, int rounds) {
      check_moving_as_one(backend, mesh, one_in, rounds);
    });
  });
}

}  // namespace pliant::test::refined_nodes_suite
