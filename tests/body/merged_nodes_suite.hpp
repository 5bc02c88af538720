#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/body/family_momentum_on.hpp>
#include <pliant/body/gone_nodes_on.hpp>
#include <pliant/body/nodal_masses_on.hpp>
#include <pliant/topology/plan.hpp>

#include "body/changed_nodes.hpp"
#include "support/formulations.hpp"

// What belongs to the nodes of a mesh that is coarsened, in a backend's memory, beside what the host makes of it.
namespace pliant::test::merged_nodes_suite {

using namespace changed_nodes;

template <class M>
std::optional<TopologyPlan<M>> plan_of(std::shared_ptr<Topology<M> const> const& topology,
                                       MarkedElements const& marked) {
  return plan_change(topology, marked, {}, {},
                     {.widths = {0}, .places = {{{}}}, .set_by_place = {{}}});
}
template <class M>
std::vector<Index> some_elements(Topology<M> const& topology, Random& random, std::size_t one_in) {
  std::vector<Index> some;
  for (std::size_t e = 0; e < topology.counts()[0]; ++e)
    if (random.below(one_in) == 0) some.push_back(static_cast<Index>(e));
  return some;
}
/// Refines some elements, twice.
template <class M>
std::shared_ptr<Topology<M> const> refined(M const& mesh, Random& random, std::size_t one_in) {
  std::shared_ptr<Topology<M> const> topology = std::make_shared<Topology<M>>(mesh);
  for (std::size_t const often : {std::size_t{1}, one_in}) {
    auto const plan = plan_of(topology, {.refine = {some_elements(*topology, random, 1 + often)}});
    REQUIRE(plan.has_value());
    topology = plan->after;
  }
  return topology;
}
/// Marks all but one of so many elements.
template <class M>
std::vector<Index> most_elements(Topology<M> const& topology, Random& random, std::size_t not_of) {
  std::vector<Index> some;
  for (std::size_t e = 0; e < topology.counts()[0]; ++e)
    if (random.below(not_of) != 0) some.push_back(static_cast<Index>(e));
  return some;
}

/// The nodes of a mesh that the host coarsens, by rows of fields in a backend's memory.
template <Element E, class B>
struct MergedNodes {
  using M = Mesh<E>;
  using T = typename B::scalar;
  static constexpr int dim = E::dim, width = E::nodes + 1;
  using Field = std::vector<Point<dim>>;
  template <class U>
  using Array = typename B::template Array<U>;

  B backend;
  TopologyPlan<M> const& plan;
  std::vector<Index> before, now;  // rows, by the user's numbers
  std::vector<Index> gone;         // rows
  Index rows;
  InterpolationOn<B> slaves_before, slaves_now;
  MassWeightsOn<B> weights_before, weights_now;
  NodalMassesOn<B> masses;
  FamilyMomentumOn<E::dim, B> momentum;
  Array<double> points, kilograms;
  Array<Index> elements_before, elements_now;
  Array<MergedFamily> families;
  detail::MergedElements<E> merged;

  MergedNodes(B const& on, TopologyPlan<M> const& of, Random& random)
      : backend(on),
        plan(of),
        before(random_rows(random)),
        now(rows_now()),
        gone(rows_gone()),
        rows(static_cast<Index>(before.size()) + free_rows),
        slaves_before(backend, plan.before->interpolation, RowOf{before}),
        slaves_now(backend, plan.after->interpolation, RowOf{now}),
        weights_before(backend, slaves_before, rows),
        weights_now(backend, slaves_now, rows),
        masses(backend, {}, detail::unit_of_masses(density, 1), density),
        momentum(backend) {
    auto const host = masses_on_host(*plan.before);
    masses = {backend, by_row(host.own), host.mass_unit, density};
    std::vector<double> places(node_stride * at(rows));
    for (std::size_t i = 0; i < before.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        places[node_stride * at(before[i]) + k] = plan.before->point(static_cast<Index>(i))[k];
    points = upload(backend, places);
    kilograms = zeros<double>(backend, at(rows));
    elements_before = element_rows(*plan.before, before);
    elements_now = element_rows(*plan.after, now);
    std::vector<MergedFamily> list;
    int wrong = 0;
    for (auto const& family : plan.transfer.families()) {
      bool are_consecutive = family.after.size() == 1;
      for (std::size_t k = 0; k < family.before.size(); ++k)
        are_consecutive &=
            family.before[k].element == family.before[0].element + static_cast<Index>(k);
      wrong += are_consecutive ? 0 : 1;
      list.push_back({.place = family.after[0].element,
                      .first_before = family.before[0].element,
                      .children = static_cast<Index>(family.before.size())});
    }
    REQUIRE(wrong == 0);
    families = upload(backend, list);
    merged = {LeavesView{.families = families.data(),
                         .merged = static_cast<Index>(list.size()),
                         .count = static_cast<Index>(plan.after->counts()[0])},
              static_cast<Index>(list.size()),
              {elements_before.data(), width},
              {elements_now.data(), width},
              detail::ElementsByRows<E>({points.data(), rows})};
  }

  /// Values of the nodes before.
  template <class U>
  std::vector<U> by_row(std::vector<U> const& values) const {
    std::vector<U> list(at(rows));
    for (std::size_t i = 0; i < values.size(); ++i) list[at(before[i])] = values[i];
    return list;
  }
  Array<T> padded(Field const& field) const {
    std::vector<T> values(node_stride * at(rows));
    for (std::size_t i = 0; i < field.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        values[node_stride * at(before[i]) + k] = static_cast<T>(field[i][k]);
    return upload(backend, values);
  }
  /// Of nodes in these rows.
  Field field_of(Array<T> const& array, std::vector<Index> const& of) const {
    auto const values = download<T>(array);
    Field field;
    for (Index const row : of)
      for (std::size_t k = 0; k < dim; ++k)
        (k == 0 ? field.emplace_back() : field.back())[k] =
            static_cast<double>(values[node_stride * at(row) + k]);
    return field;
  }
  std::vector<detail::ExactSum> sums_by_row() const {
    auto own = zeros<detail::ExactSum>(backend, at(rows));
    detail::copy_values(backend, masses.own(), own.data(), own.size());
    return download<detail::ExactSum>(own);
  }
  template <class U>
  static std::vector<U> taken(std::vector<U> const& by_row, std::vector<Index> const& of) {
    std::vector<U> values;
    for (Index const row : of) values.push_back(by_row[at(row)]);
    return values;
  }

  /// Brings masses and velocities to the coarser mesh; returns what held nodes took.
  Point<dim> merge(Array<T>& v, Array<DirectionMask> const& held, double bound = 64 * density) {
    momentum.begin(weights_before, weights_now, masses, merged);
    masses.read(weights_now, kilograms.data());
    auto rounded = zeros<T>(backend, at(rows));
    masses.round(kilograms.data(), rounded.data());
    momentum.give_back(weights_before, weights_now, density, bound, kilograms.data(), held.data(),
                       node_field<dim>(v), merged);
    backend.synchronize();
    masses.template check<T>();
    return momentum.taken();
  }

 private:
  static constexpr Index free_rows = 7;
  struct RowOf {
    std::vector<Index> const& rows;
    Index operator()(Index node) const { return rows[at(node)]; }
  };

  std::vector<Index> random_rows(Random& random) const {
    std::vector<Index> list(at(plan.before->nodes() + free_rows));
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = static_cast<Index>(i);
    random.shuffle(list);
    list.resize(list.size() - free_rows);
    return list;
  }
  std::vector<Index> rows_now() const {
    std::vector<Index> list(at(plan.after->nodes()));
    for (std::size_t i = 0; i < before.size(); ++i)
      if (Index const node = plan.transfer.renumbered(static_cast<Index>(i)); node >= 0)
        list[at(node)] = before[i];
    return list;
  }
  std::vector<Index> rows_gone() const {
    std::vector<Index> list;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (plan.transfer.renumbered(static_cast<Index>(i)) < 0) list.push_back(before[i]);
    return list;
  }
  Array<Index> element_rows(Topology<M> const& topology, std::vector<Index> const& row_of) const {
    std::vector<Index> list;
    for (auto const& nodes : topology.mesh().template elements<E>()) {
      for (Index const node : nodes) list.push_back(row_of[at(node)]);
      list.push_back(-1);
    }
    return upload(backend, list);
  }
};

template <class T, class Field>
Field rounded(Field field) {
  for (auto& point : field)
    for (double& x : point) x = static_cast<double>(static_cast<T>(x));
  return field;
}

template <class B, Element E>
void check_masses(MergedNodes<E, B>& nodes) {
  auto const sums_before = nodes.sums_by_row();
  auto const after = masses_on_host(*nodes.plan.after);
  nodes.masses.take_gone(nodes.merged);
  nodes.masses.add_come(nodes.merged);
  nodes.masses.read(nodes.weights_now, nodes.kilograms.data());
  auto const sums = nodes.sums_by_row();
  CHECK(nodes.taken(sums, nodes.now) == after.own);
  auto const kilograms = download<double>(nodes.kilograms);
  CHECK(nodes.taken(kilograms, nodes.now) == after.kilograms);
  int wrong = 0;
  for (Index const row : nodes.gone)
    wrong += sums[at(row)] != detail::ExactSum{} || kilograms[at(row)] != 0;
  CHECK(wrong == 0);
  nodes.masses.take_back(nodes.merged);
  CHECK(nodes.sums_by_row() == sums_before);
  CHECK(sums != sums_before);
}

/// Nodes that went lay where the host says, and hand on the loads that they had.
template <class B, Element E>
void check_loads(MergedNodes<E, B>& nodes, GoneNodesOn<B>& gone_nodes, Random& random) {
  using T = typename B::scalar;
  auto const& transfer = nodes.plan.transfer;
  REQUIRE(nodes.gone.size() == transfer.gone().size());
  auto const list = upload(nodes.backend, nodes.gone);
  auto const count = static_cast<Index>(nodes.gone.size());
  auto between = gone_nodes.rows(list.data(), count, nodes.rows, nodes.merged);
  REQUIRE(between.count == count);
  auto const first = download<Index>(between.first), other = download<Index>(between.other);
  auto const weight = download<T>(between.weight);
  CHECK(download<Index>(between.node) == nodes.gone);
  using Entries = std::vector<std::pair<Index, double>>;
  int wrong = 0;
  for (std::size_t k = 0; k < nodes.gone.size(); ++k) {
    auto const wanted = transfer.gone()[k];
    wrong += nodes.before[at(wanted.node)] != nodes.gone[k];
    Entries own, of_host;
    for (auto i = at(first[k]); i < at(first[k + 1]); ++i)
      own.emplace_back(other[i], static_cast<double>(weight[i]));
    for (auto const& [node, w] : wanted.parents) of_host.emplace_back(nodes.before[at(node)], w);
    std::ranges::sort(own);
    std::ranges::sort(of_host);
    wrong += own != of_host;
  }
  CHECK(wrong == 0);

  auto const loads = rounded<T>(random.field<E::dim>(nodes.before.size(), 1));
  auto field = nodes.padded(loads);
  InterpolationOn<B>(nodes.backend, std::move(between))
      .apply_transpose(nodes.backend, node_field<E::dim>(field));
  auto const carried = transfer.carry_sums(loads);
  auto const found = nodes.field_of(field, nodes.now);
  double most = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = 0; k < E::dim; ++k)
      most = std::max(most, std::abs(found[i][k] - carried[i][k]));
  // Products with the weights of linear elements are not rounded, and sums are in the same order: of floats, 32 or so by floats, here,
  // and by doubles on the host. Those with weights of quadratic ones are, or not, where a compiler fuses them with sums.
  bool const is_exact = std::same_as<T, double> && E::degree == 1;
  CHECK(most <= (is_exact ? 0 : 32 * double{std::numeric_limits<T>::epsilon()}));
  for (auto const& load : nodes.field_of(field, nodes.gone)) wrong += load != Point<E::dim>{};
  CHECK(wrong == 0);
}

template <class B, Element E>
void check_velocities(MergedNodes<E, B>& nodes, Random& random) {
  using T = typename B::scalar;
  constexpr std::size_t dim = E::dim;
  double const epsilon{std::numeric_limits<T>::epsilon()};
  auto const& plan = nodes.plan;
  auto const given = rounded<T>(random.field<dim>(nodes.before.size(), 1));
  std::vector<DirectionMask> held(nodes.before.size(), 0), held_now(nodes.now.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    held[i] = static_cast<DirectionMask>(random.below(1u << dim));
    Index const node = plan.transfer.renumbered(static_cast<Index>(i));
    if (node >= 0) held_now[at(node)] = held[i];
  }
  auto const before = masses_on_host(*plan.before), after = masses_on_host(*plan.after);
  auto v = nodes.padded(given);
  auto const staying = nodes.field_of(v, nodes.now), gone = nodes.field_of(v, nodes.gone);
  auto const held_rows = upload(nodes.backend, nodes.by_row(held));
  auto const taken = nodes.merge(v, held_rows);
  CHECK(nodes.field_of(v, nodes.gone) == gone);

  auto const old_nodes = all_nodes(plan.before->nodes()),
             new_nodes = all_nodes(plan.after->nodes());
  auto wanted = at_all<E::dim>(new_nodes, staying);
  detail::TouchedElements<Mesh<E>> const touched(*plan.before, *plan.after, plan.transfer,
                                                 [](auto const&) { return NoneStays{}; });
  auto const wanted_taken = detail::give_momentum_back(plan, touched, density, after, held_now,
                                                       at_all<E::dim>(old_nodes, given), wanted);
  auto const found = nodes.field_of(v, nodes.now);
  double most = 0, changed = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = 0; k < dim; ++k) {
      most = std::max(most, std::abs(found[i][k] - wanted.values[i][k]));
      changed = std::max(changed, std::abs(wanted.values[i][k] - staying[i][k]));
    }
  CHECK(most <= 8 * epsilon);
  CHECK(changed > 0.01);
  auto const p_before = momentum_of<E::dim>(before.kilograms, given);
  auto const p = momentum_of<E::dim>(after.kilograms, found);
  for (std::size_t k = 0; k < dim; ++k) {
    CHECK(taken[k] == Approx(wanted_taken[k]).margin(32 * epsilon));
    CHECK(std::abs(taken[k]) > 1e-6);
    CHECK(p[k] + taken[k] == Approx(p_before[k]).margin(32 * epsilon));
  }
}

/// Nothing is rounded where all move as one. An impulse beyond the bound leaves velocities as they are.
template <class B, Element E>
void check_bits(MergedNodes<E, B>& nodes, Random& random) {
  using T = typename B::scalar;
  using Field = std::vector<Point<E::dim>>;
  auto const held = upload(nodes.backend, std::vector<DirectionMask>(at(nodes.rows), 0));
  auto const random_v = rounded<T>(random.field<E::dim>(nodes.before.size(), 1));
  auto v = nodes.padded(random_v);
  CHECK_THROWS_WITH(nodes.merge(v, held, 1e-9), says("exceeds the bound of 1e-09 kg m/s"));
  CHECK(nodes.field_of(v, nodes.before) == random_v);
  nodes.masses.take_back(nodes.merged);
  Field const as_one(nodes.before.size(), random_v[0]);
  v = nodes.padded(as_one);
  CHECK(nodes.merge(v, held) == Point<E::dim>{});
  CHECK(nodes.field_of(v, nodes.before) == as_one);
}

/// Calls check(nodes, random) for meshes that are coarsened again and again.
template <class B, Element E, class Check>
void on_rounds(B const& backend, Mesh<E> const& mesh, std::size_t one_in, Check const& check) {
  Random random(5);
  auto topology = refined(mesh, random, one_in);
  std::size_t hung = 0, freed = 0;
  for (int round = 0; round < 3; ++round) {
    std::size_t const not_of = E::dim == 2 ? 6 : 16;
    auto const plan = plan_of(topology, {.coarsen = {most_elements(*topology, random, not_of)}});
    REQUIRE(plan.has_value());
    REQUIRE(plan->transfer.new_nodes().size() == 0);
    REQUIRE(plan->transfer.families().size() > 0);
    MergedNodes<E, B> nodes(backend, *plan, random);
    hung += plan->after->interpolation.slaves().size();
    freed += nodes.gone.size();
    check(nodes, random);
    topology = plan->after;
  }
  CHECK(hung > 0);
  CHECK(freed > 0);
}
/// Does so on meshes of each linear element that can be refined, and of some quadratic ones.
template <class Check>
void on_meshes(Check const& check) {
  on_each_backend<AllBackends>([&]<class B>(B const& backend) {
    on_rounds(backend, shaken(regular_mesh<Tri3>(8), 0.01), 4, check);
    on_rounds(backend, shaken(regular_mesh<Quad4>(8), 0.01), 4, check);
    on_rounds(backend, shaken(regular_mesh<Tet4>(3), 0.03), 6, check);
    on_rounds(backend, shaken(regular_mesh<Hex8>(3), 0.03), 6, check);
    on_rounds(backend, mesh::raised<Quad8>(shaken(regular_mesh<Quad4>(6), 0.01)), 4, check);
    on_rounds(backend, mesh::raised<Tet10>(shaken(regular_mesh<Tet4>(2), 0.03)), 6, check);
  });
}

TEST_CASE("nodes of coarsened meshes have the masses that the host gives them", "[body]") {
  on_meshes([](auto& nodes, Random&) { check_masses(nodes); });
}

TEST_CASE("nodes that go in a backend's memory lay where the host says, and hand on their loads",
          "[body]") {
  on_meshes([]<Element E, class B>(MergedNodes<E, B>& nodes, Random& random) {
    GoneNodesOn<B> gone_nodes(nodes.backend);
    check_loads(nodes, gone_nodes, random);
    check_loads(nodes, gone_nodes, random);
  });
}

TEST_CASE("elements that are merged in a backend's memory keep their momentum as on the host",
          "[body]") {
  on_meshes([](auto& nodes, Random& random) { check_velocities(nodes, random); });
}

TEST_CASE("coarsening keeps every bit of velocities where all nodes move as one, or it is refused",
          "[body]") {
  on_meshes([](auto& nodes, Random& random) { check_bits(nodes, random); });
}

}  // namespace pliant::test::merged_nodes_suite
