#pragma once

#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/mesh/with_types.hpp>

#include "topology/mixed_meshes.hpp"

// Bodies whose elements are split into such of another shape and merged again, beside refinement.
namespace pliant::test::shape_suite {

struct Plane {
  static constexpr int dim = 2;
  using mesh_type = Mesh<Tri3, Quad4>;
  using Whole = Formulation<Quad4, Gauss<2>, NeoHookean>;
  using Part = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using WholeSoft = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using PartSoft = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
  static constexpr int part = 0, whole = 1;
  static constexpr std::size_t parts = 4;
  template <class B>
  using body_type = Body<B, mesh_type, Whole, PartSoft, WholeSoft, Part>;

  static mesh_type mesh() { return mesh::with_types<Tri3, Quad4>(distorted_mesh<Quad4>(5)); }
  template <class B>
  static body_type<B> body(B const& backend) {
    return body_type<B>(backend, mesh(), soft, Group<Whole>{}, Group<PartSoft>{},
                        Group<WholeSoft>{}, Group<Part>{});
  }
};
struct Solid {
  static constexpr int dim = 3;
  using mesh_type = Mesh<Hex8, Pyramid5, Tet4>;
  using Whole = Formulation<Hex8, Gauss<2>, NeoHookean>;
  using Part = Formulation<Pyramid5, Gauss<2>, NeoHookean>;
  using WholeSoft = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
  using PartSoft = Formulation<Pyramid5, Gauss<2>, SaintVenantKirchhoff>;
  using Tets = Formulation<Tet4, Gauss<1>, NeoHookean>;
  static constexpr int whole = 0, part = 1;
  static constexpr std::size_t parts = 6;
  template <class B>
  using body_type = Body<B, mesh_type, Whole, PartSoft, WholeSoft, Part, Tets>;

  static mesh_type mesh() {
    return mesh::with_types<Hex8, Pyramid5, Tet4>(distorted_mesh<Hex8>(3));
  }
  template <class B>
  static body_type<B> body(B const& backend) {
    return body_type<B>(backend, mesh(), soft, Group<Whole>{}, Group<PartSoft>{},
                        Group<WholeSoft>{}, Group<Part>{}, Group<Tets>{});
  }
};

/// Calls visit(B{}, case): both on each backend.
template <class Bs, class Visit>
void on_cases(Visit const& visit) {
  on_each_backend<Bs>([&]<class B>(B const& backend) {
    visit(backend, Plane{});
    visit(backend, Solid{});
  });
}

/// All elements into which others are split.
template <class TheBody>
std::vector<std::vector<Index>> all_parts(TheBody const& body) {
  auto lists = all(body, -1);
  detail::for_each_type_of<std::remove_cvref_t<decltype(body.mesh())>>(
      [&]<Element E>(E, std::size_t type) {
        if (!is_part<E>) lists[type].clear();
      });
  return lists;
}

/// Splits, refines, merges and coarsens at random.
template <class P, class TheBody>
void split_at_random(TheBody& body, Random& random) {
  bool const solid = TheBody::dim == 3;
  split(body, some(body, 3, random, P::whole));
  refine(body, some(body, solid ? 12 : 5, random, -1), 3);
  split(body, some(body, 4, random, P::whole), {.triangles = 2});
  if (solid) split(body, some(body, 3, random, P::part));
  refine(body, some(body, solid ? 40 : 6, random, -1), 3);
  if (solid) split(body, some(body, 6, random, P::part));
  merge(body, some(body, 1, random, P::part));
  coarsen(body, some(body, 1 + random.below(2), random, -1));
  split(body, some(body, 3, random, P::whole));
  refine(body, some(body, solid ? 60 : 8, random, -1), 2);
}
/// Back to the mesh of the beginning.
template <class P, class TheBody>
void undo(TheBody& body) {
  do coarsen(body, all(body, -1));
  while (merge(body, all_parts(body)).merged > 0 || coarsen(body, all(body, -1)).merged > 0);
}

template <class P, class TheBody>
void to_one_law(TheBody& body) {
  assign_all<typename P::Whole>(body);
  assign_all<typename P::Part>(body);
  if constexpr (P::dim == 3) assign_all<typename P::Tets>(body);
}

TEST_CASE("a quadrilateral is split into triangles, and a hexahedron into pyramids", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    auto const before = body.mesh();
    std::vector<std::vector<Index>> marked(P::dim == 2 ? 2 : 3);
    marked[P::whole] = {1};
    auto const corners = elements<P::whole>(body)[1];

    auto const report = split(body, marked);

    CHECK(report.split == 1);
    CHECK(report.new_nodes == 1);
    CHECK(body.mesh().slaves.empty());
    CHECK(body.mesh().boundaries == before.boundaries);
    CHECK(elements<P::whole>(body).size() == std::get<P::whole>(before.tables).size() - 1);
    auto const& parts = elements<P::part>(body);
    REQUIRE(parts.size() == P::parts);
    Point<P::dim> middle{};
    for (Index node : corners)
      for (std::size_t k = 0; k < P::dim; ++k)
        middle[k] += before.nodes[static_cast<std::size_t>(node)][k] / double(corners.size());
    for (std::size_t k = 0; k < P::dim; ++k)
      CHECK(body.mesh().nodes.back()[k] == Approx(middle[k]).epsilon(1e-14));
    for (auto const& nodes : parts) CHECK(nodes.back() == body.nodes() - 1);
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    CHECK(ledger(body).back().action == "split");

    std::vector<std::vector<Index>> some_parts(marked.size()), all_parts(marked.size());
    some_parts[P::part] = first_numbers(P::parts - 1);
    all_parts[P::part] = first_numbers(P::parts);
    CHECK(merge(body, some_parts).merged == 0);
    CHECK(coarsen(body, all_parts).merged == 0);
    auto const merged = merge(body, all_parts);
    CHECK(merged.merged == 1);
    CHECK(merged.gone_nodes == 1);
    CHECK(body.mesh().tables == before.tables);
    CHECK(body.mesh().nodes == before.nodes);
    CHECK(ledger(body).back().action == "merge");
  });
}

TEST_CASE("two triangles meet at the shorter diagonal", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Mesh<Quad4, Tri3> mesh;
    mesh.nodes = {{0, 0}, {1, 0}, {1.5, 1}, {0.5, 1}, {2, 0}, {2, 1}, {3, 0}, {2.9, 0.9}};
    mesh.elements<Quad4>() = {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}};
    using Whole = Formulation<Quad4, Gauss<2>, Hooke>;
    using Part = Formulation<Tri3, Gauss<1>, Hooke>;
    Body body(backend, mesh, soft, Group<Whole>{}, Group<Part>{});
    CHECK(split(body, {{0, 2}, {}}, {.triangles = 2}).new_nodes == 0);
    CHECK(elements<1>(body) ==
          std::vector<Connectivity<Tri3>>{{1, 2, 3}, {3, 0, 1}, {4, 6, 7}, {7, 5, 4}});
    CHECK(elements<0>(body) == std::vector<Connectivity<Quad4>>{{1, 4, 5, 2}});
    merge(body, {{}, {0, 1, 2, 3}});
    CHECK(body.mesh().tables == mesh.tables);
    // Of equal ones that from corner 0.
    Mesh<Quad4, Tri3> square;
    square.nodes = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.elements<Quad4>() = {{0, 1, 2, 3}};
    Body of_square(backend, square, soft, Group<Whole>{}, Group<Part>{});
    split(of_square, {{0}, {}}, {.triangles = 2});
    CHECK(elements<1>(of_square) == std::vector<Connectivity<Tri3>>{{0, 1, 2}, {2, 3, 0}});
  });
}

TEST_CASE("a pyramid is refined into pyramids and tetrahedra", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = Solid::body(backend);
    split(body, {{0}, {}, {}});
    auto const split_mesh = body.mesh();
    auto const report = refine(body, {{}, {2}, {}});
    CHECK(report.refined == 1);
    CHECK(elements<1>(body).size() == 5 + 6);
    CHECK(elements<2>(body).size() == 4);
    CHECK(refinement_levels<Pyramid5>(body) == std::vector<int>{0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1});
    CHECK(refinement_levels<Tet4>(body) == std::vector<int>(4, 1));
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    CHECK_FALSE(body.mesh().slaves.empty());
    // Its hexahedron cannot come back before it does.
    CHECK(merge(body, all(body, 1)).merged == 0);
    CHECK(coarsen(body, all(body, -1)).merged == 1);
    CHECK(body.mesh().tables == split_mesh.tables);
    CHECK(body.mesh().nodes == split_mesh.nodes);
    // Refined again and again, they stay within one level of others.
    refine(body, {{}, {0, 1, 2, 3, 4, 5}, {}});
    {
      Random random(2);
      refine(body, some(body, 20, random, -1), 3);
    }
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    CHECK(merge(body, all(body, 1)).merged == 0);
    undo<Solid>(body);
    CHECK(body.mesh().tables == Solid::mesh().tables);
  });
}

TEST_CASE("two pyramids that share a base are split into tetrahedra, both or none", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Mesh<Hex8, Pyramid5, Tet4> mesh = mesh::with_types<Hex8, Pyramid5, Tet4>(
        mesh::box<Hex8>({.size = {2, 1, 1}, .cells = {2, 1, 1}}));
    for (auto& x : mesh.nodes)
      x[2] += 0.25 * x[1];  // the side between them has diagonals of two lengths
    using Whole = Formulation<Hex8, Gauss<2>, NeoHookean>;
    using Part = Formulation<Pyramid5, Gauss<2>, NeoHookean>;
    using Tets = Formulation<Tet4, Gauss<1>, NeoHookean>;
    Body body(backend, mesh, soft, Group<Whole>{}, Group<Part>{}, Group<Tets>{});
    split(body, {{0, 1}, {}, {}});
    auto const pyramids = body.mesh();
    double const mass = total_mass(body);
    std::vector<Index> at_base;  // those whose base lies between the two
    for (Index e = 0; e < 12; ++e) {
      auto const& nodes = elements<1>(body)[static_cast<std::size_t>(e)];
      if (std::ranges::all_of(std::span(nodes).first(4), [&](Index node) {
            return body.mesh().nodes[static_cast<std::size_t>(node)][0] == 1;
          }))
        at_base.push_back(e);
    }
    REQUIRE(at_base.size() == 2);
    std::vector<Index> others = first_numbers(12);
    std::erase_if(others, [&](Index e) { return e == at_base[0] || e == at_base[1]; });
    CHECK(split(body, {{}, others, {}}).split == 0);  // nothing lies behind their bases

    auto const merging = plan_change(
        body.parts(), {.split = {{}, {at_base[1]}, {}}, .merge = {{}, first_numbers(6), {}}});
    REQUIRE(merging);  // of the first hexahedron, and one pyramid with it
    CHECK(merging->counts.merged == 1);
    CHECK(merging->counts.split == 0);

    CHECK(split(body, {{}, {at_base[1]}, {}}).split == 2);
    CHECK(elements<1>(body).size() == 10);
    REQUIRE(elements<2>(body).size() == 4);
    CHECK(body.mesh().slaves.empty());
    CHECK(body.mesh().boundaries == pyramids.boundaries);
    CHECK(total_mass(body) == Approx(mass).epsilon(1e-14));
    // All of them have the shorter diagonal for an edge.
    std::vector<Index> diagonal;
    for (Index node = 0; node < body.nodes(); ++node)
      if (std::ranges::all_of(elements<2>(body), [&](auto const& nodes) {
            return std::ranges::count(nodes, node) == 1;
          }))
        diagonal.push_back(node);
    REQUIRE(diagonal.size() == 2);
    Point<3> apart{};
    for (std::size_t k = 0; k < 3; ++k)
      apart[k] = body.mesh().nodes[static_cast<std::size_t>(diagonal[1])][k] -
                 body.mesh().nodes[static_cast<std::size_t>(diagonal[0])][k];
    CHECK(std::abs(apart[1] * apart[2]) == Approx(0.75));

    CHECK(merge(body, {{}, {}, {0, 1, 2}}).merged == 0);
    CHECK(coarsen(body, all(body, 2)).merged == 0);
    refine(body, {{}, {}, {0}});
    CHECK(merge(body, all(body, 2)).merged == 0);
    coarsen(body, all(body, -1));
    // Where one of them would be refined again, both stay.
    refine(body, {{}, {others[0], others[1], others[2], others[3], others[4]}, {}});
    auto plan = plan_change(body.parts(), {.refine = all(body, 1), .merge = all(body, 2)});
    REQUIRE(plan);
    CHECK(plan->counts.merged == 0);
    CHECK(plan->counts.refined > 10);
    coarsen(body, all(body, -1));
    // Where one of them alone would be, both stay too: the child at the apex is on an edge of that one's.
    Index const apex = elements<1>(body)[1][4];
    refine(body, {{}, {1}, {}});
    auto const levels = refinement_levels<Pyramid5>(body);
    std::vector<Index> at_apex;
    for (std::size_t e = 0; e < levels.size(); ++e)
      if (levels[e] == 1 && std::ranges::count(elements<1>(body)[e], apex) == 1)
        at_apex.push_back(static_cast<Index>(e));
    REQUIRE(at_apex.size() == 1);
    plan = plan_change(body.parts(), {.refine = {{}, at_apex, {}}, .merge = all(body, 2)});
    REQUIRE(plan);
    CHECK(plan->counts.refined > 1);
    CHECK(plan->counts.merged == 0);
    coarsen(body, all(body, -1));
    CHECK(merge(body, all(body, 2)).merged == 2);
    CHECK(body.mesh().tables == pyramids.tables);
    CHECK(merge(body, all(body, 1)).merged == 2);
    CHECK(body.mesh().tables == mesh.tables);
  });
}

TEST_CASE("a mesh of split elements passes the patch test", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    Random random(5);
    split_at_random<P>(body, random);
    REQUIRE(elements<0>(body).size() > 0);
    REQUIRE(elements<1>(body).size() > 0);
    if constexpr (P::dim == 3) REQUIRE(elements<2>(body).size() > 0);
    REQUIRE_FALSE(body.mesh().slaves.empty());
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-13));
    to_one_law<P>(body);
    check_patch<typename P::Whole>(body);
  });
}

TEST_CASE("displacements of split elements are continuous", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    Random random(3);
    split_at_random<P>(body, random);
    check_continuity(body, random);
  });
}

TEST_CASE("fields, momentum and energy are kept when shapes change, and the mesh comes back",
          "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    check_what_is_kept(
        body, [](auto& own, Random& random) { split_at_random<P>(own, random); },
        [](auto& own) { undo<P>(own); });
  });
}

TEST_CASE("parts go to the group of their law, and the whole to that of most parts", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    using Whole = typename P::Whole::element;
    using Part = typename P::Part::element;
    body.template assign<typename P::WholeSoft>({1});
    std::vector<std::vector<Index>> marked(P::dim == 2 ? 2 : 3);
    marked[P::whole] = {0, 1};
    split(body, marked);
    auto groups = body.template groups_of<Part>();
    REQUIRE(groups.size() == 2 * P::parts);
    for (std::size_t e = 0; e < groups.size(); ++e) CHECK(groups[e] == (e < P::parts ? 1 : 0));
    auto most = first_numbers(P::parts / 2 + 1);
    body.template assign<typename P::PartSoft>(most);
    merge(body, all(body, P::part));
    groups = body.template groups_of<Whole>();
    CHECK(groups[0] == 1);
    CHECK(groups[1] == 1);
    CHECK(std::ranges::count(groups, Tag{1}) == 2);
  });
}

TEST_CASE("conditions, pressures and loads go along with shapes", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    auto const mesh = body.mesh();
    body.clamp(mesh.boundary("left"));
    body.press(mesh.boundary("right"), 0.25);
    auto const pressure = total(body.forces());
    split(body, all(body, P::whole));
    CHECK(elements<P::whole>(body).empty());
    CHECK(body.mesh().boundaries == mesh.boundaries);
    CHECK(body.state().prescribed->conditions[0].nodes == nodes_of(mesh.boundary("left")));
    auto const now = total(body.forces());
    for (std::size_t k = 0; k < P::dim; ++k) CHECK(now[k] == Approx(pressure[k]).margin(1e-13));

    // The loads of nodes that go are handed to the corners.
    Point<P::dim> load{};
    load[1] = 0.125;
    body.set_load(body.nodes() - 1, load);
    std::vector<Index> const named{body.nodes() - 2};
    body.clamp(named);
    auto const wholes = std::get<P::whole>(mesh.tables).size();
    CHECK(merge(body, all(body, P::part)).merged == wholes - 1);  // but where a node is held
    CHECK(elements<P::part>(body).size() == P::parts);
    CHECK(body.state().prescribed->conditions[1].nodes.size() == 1);
    Point<P::dim> sum{};
    for (auto const& own : nodal_loads(body))
      for (std::size_t k = 0; k < P::dim; ++k) sum[k] += own[k];
    for (std::size_t k = 0; k < P::dim; ++k) CHECK(sum[k] == Approx(load[k]).margin(1e-15));
  });
}

TEST_CASE("a body of split elements steps, saves and resumes", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    check_resuming([&] { return P::body(backend); },
                   [](auto& own, Random& random) { split_at_random<P>(own, random); },
                   [](auto& own) { undo<P>(own); });
  });
}

TEST_CASE("forces on a mesh of split elements are the same on all backends", "[topology]") {
  on_each_backend<std::tuple<MainBackend>>([](auto const& backend) {
    auto const check = [&]<class P>(P) {
      check_agreement(
          backend, [](auto const& on) { return P::body(on); },
          [](auto& own, Random& random) { split_at_random<P>(own, random); });
    };
    check(Plane{});
    check(Solid{});
  });
}

TEST_CASE("rules split, refine and merge by criteria", "[topology]") {
  on_cases<MainAlone>([]<class B, class P>(B const& backend, P) {
    auto body = P::body(backend);
    auto const mesh = body.mesh();
    using Whole = typename P::Whole;
    using Part = typename P::Part;
    Adaptation adapt{when<Whole>(StrainNorm{}).above(0.2).refine({.max_level = 1}),
                     when<Whole>(StrainNorm{}).above(0.02).split({.triangles = 2}),
                     when<Part>(StrainNorm{}).below(0.01).merge(),
                     when<Whole>(StrainNorm{}).below(0.01).coarsen()};
    auto const stretch = [&](double amount) {
      FieldOf<P::dim> u;
      for (auto const& x : body.mesh().nodes) {
        auto& own = u.emplace_back();
        own[0] = amount * std::max(x[0] - 0.5, 0.0);
      }
      body.set_displacements(u);
    };
    stretch(0.001);
    adapt.now(body);
    CHECK(body.mesh().tables == mesh.tables);
    stretch(0.05);
    adapt.now(body);
    std::size_t const parts = P::dim == 2 ? 2 : 6;
    auto const split = std::get<P::whole>(mesh.tables).size() - elements<P::whole>(body).size();
    CHECK(split > 0);
    CHECK(elements<P::whole>(body).size() > 0);
    CHECK(elements<P::part>(body).size() == parts * split);
    CHECK(ledger(body).back().action == "split");
    CHECK(ledger(body).back().elements == static_cast<double>(split));
    stretch(0);
    adapt.now(body);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(body.mesh().tables == mesh.tables);
    stretch(0.5);  // of what is refined nothing is split in the same look
    adapt.now(body);
    CHECK(ledger(body).back().action.starts_with("refine"));
    stretch(0);
    for (int k = 0; k < 4; ++k) adapt.now(body);
    CHECK(body.mesh().tables == mesh.tables);
    CHECK_THROWS_WITH(when<Whole>(StrainNorm{}).above(1).split({.triangles = 3}),
                      says("3 triangles"));
    CHECK_THROWS_WITH(when<Part>(StrainNorm{}).below(1).stay(2).merge(), says("no stay"));
  });
}

TEST_CASE("what is refined is not split, and parts that would be refined are not merged",
          "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const change_at_once = [](auto& body, MarkedElements const& marked) {
      auto const plan = plan_change(body.parts(), marked);
      REQUIRE(plan);
      commit(body.parts(), *plan);
      return plan->counts;
    };
    // The children of the one in the middle are refined, and with them its four neighbours.
    auto body = Plane::body(backend);
    refine(body, {{}, {9}});
    auto const children = std::vector<Index>{19, 20, 21, 22};
    auto counts = change_at_once(body, {.refine = {{}, children}, .split = {{}, {0, 10}}});
    CHECK(counts.refined == 4 + 4);
    CHECK(counts.split == 1);
    CHECK(elements<0>(body).size() == 4);

    auto other = Plane::body(backend);
    refine(other, {{}, {9}});
    split(other, {{}, {0, 10}});
    auto const middle = std::vector<Index>{17, 18, 19, 20};
    CHECK(refinement_levels<Quad4>(other)[17] == 1);
    counts = change_at_once(other, {.refine = {{}, middle}, .merge = all(other, 0)});
    CHECK(counts.refined == 4 + 3 + 1);
    CHECK(counts.merged == 1);
    CHECK(elements<0>(other).size() == 3 + 4);
  });
}

TEST_CASE("parts of another degree are not merged", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::with_types<Quad4, Tri3, Tri6>(distorted_mesh<Quad4>(3));
    Body body(backend, mesh, soft, Group<Formulation<Quad4, Gauss<2>, NeoHookean>>{},
              Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{},
              Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{});
    split(body, {{4}, {}, {}});
    raise(body, {{}, {0, 1, 2, 3}, {}});
    CHECK_THROWS_WITH(merge(body, all(body, 2)), says("no element is split into Tri6"));
    lower(body, {{}, {}, {1, 2, 3}});
    CHECK(merge(body, all(body, 1)).merged == 0);
    lower(body, {{}, {}, {0}});
    CHECK(merge(body, all(body, 1)).merged == 1);
    CHECK(body.mesh().tables == mesh.tables);
  });
}

TEST_CASE("split elements take their values and what their points keep along", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Graded = Formulation<Quad4, Gauss<2>, PerElement<SaintVenantKirchhoff>::law>;
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<SaintVenantKirchhoff>::law>;
    using Graded3 = Formulation<Tri3, Gauss<1>, PerElement<SaintVenantKirchhoff>::law>;
    using Viscous3 = Formulation<Tri3, Gauss<1>, Prony<SaintVenantKirchhoff>::law>;
    auto const relaxing = [] {
      return typename Viscous::template law<double>{{3, 2}, {0.5}, {0.1}};
    };
    auto const mesh = mesh::with_types<Quad4, Tri3>(distorted_mesh<Quad4>(4));
    std::size_t const count = mesh.elements<Quad4>().size();
    Random random;
    std::vector<std::array<double, 2>> values(count);
    for (auto& v : values) v = {4 + random(), 2 + random()};
    auto const h = some_gradient<2>();
    Body body{backend,
              mesh,
              soft,
              Group<Graded>{.values = values},
              Group<Viscous3>{relaxing()},
              Group<Viscous>{relaxing()},
              Group<Graded3>{}};
    std::vector<Index> every_other;
    for (std::size_t e = 0; e < count; e += 2) every_other.push_back(static_cast<Index>(e));
    body.template assign<Viscous>(every_other);
    body.clamp(boundary_nodes(mesh));
    // A linear field is exact on every mesh; it is kept for a while, so that branches relax in part.
    take_steps(body.parts(), 0.01, 1);
    body.set_displacements(uniform(mesh.nodes, h));
    commit_at(body.parts(), std::as_const(body.parts()).u());
    set_step_size(body.parts(), 0.05);
    auto const along = uniform(mesh.nodes, h);
    double const energy = strain_energy(body), work = inner(body.forces(), along);

    split(body, {{0, 1, 4, 5}, {}});
    refine(body, {{1}, {0, 3}});
    split(body, {{0, 2}, {}}, {.triangles = 2});

    CHECK(elements<1>(body).size() > 15);
    CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
    CHECK(inner(body.forces(), uniform(body.mesh().nodes, h)) == Approx(work).epsilon(1e-13));
    do coarsen(body, all(body, -1));
    while (merge(body, all(body, 1)).merged > 0 || coarsen(body, all(body, -1)).merged > 0);
    CHECK(body.mesh().nodes == mesh.nodes);
    CHECK(strain_energy(body) == Approx(energy).epsilon(1e-13));
    CHECK(inner(body.forces(), along) == Approx(work).epsilon(1e-13));
  });
}

TEST_CASE("points take what the nearest ones keep when shapes change", "[topology]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Viscous = Formulation<Quad4, Gauss<2>, Prony<SaintVenantKirchhoff>::law>;
    using Viscous3 = Formulation<Tri3, Gauss<1>, Prony<SaintVenantKirchhoff>::law>;
    auto const relaxing = [] {
      return typename Viscous::template law<double>{{3, 2}, {0.5}, {0.1}};
    };
    Mesh<Quad4, Tri3> mesh;
    mesh.nodes = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    mesh.elements<Quad4>() = {{0, 1, 2, 3}};
    Body body{backend, mesh, soft, Group<Viscous>{relaxing()}, Group<Viscous3>{relaxing()}};
    split(body, {{0}, {}});
    FieldOf<2> u(5);
    u[1] = {0.2, -0.1};
    u[3] = {0.1, 0.3};
    u[4] = {-0.1, 0.05};
    body.set_displacements(u);
    equilibrate(body.parts());
    auto const kept = [&](std::size_t type) {
      return detail::kept_points(std::as_const(body.parts()))[type];
    };
    auto const row = [](auto const& points, std::size_t number) {
      auto const size = points.groups[0].size;
      auto const first = points.rows.begin() + static_cast<std::ptrdiff_t>(number) * size;
      return std::vector<double>(first, first + size);
    };
    auto const triangles = kept(1);
    merge(body, {{}, {0, 1, 2, 3}});
    auto const square = kept(0);
    auto const& places = square.groups[0].places;
    for (std::size_t q = 0; q < 4;
         ++q) {  // each is as near to the point of one triangle as to that of another
      std::size_t const vertical = places[q][1] < 0 ? 0 : 2, horizontal = places[q][0] > 0 ? 1 : 3;
      CHECK((row(square, q) == row(triangles, vertical) ||
             row(square, q) == row(triangles, horizontal)));
    }
    split(body, {{0}, {}}, {.triangles = 2});  // with points at (1/3, -1/3) and (-1/3, 1/3)
    auto const halves = kept(1);
    for (std::size_t q = 0; q < 4; ++q) {
      if (places[q][0] * places[q][1] > 0) continue;
      CHECK(row(halves, places[q][0] > 0 ? 0 : 1) == row(square, q));
    }
    CHECK(row(halves, 0) != row(halves, 1));
  });
}

TEST_CASE("shapes that cannot change are refused", "[topology][errors]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = Plane::body(backend);
    split(body, {{}, {0}});
    auto const nodes = body.mesh().nodes;
    CHECK_THROWS_WITH(split(body, {{0}, {}}), says("Tri3 elements cannot be split"));
    CHECK_THROWS_WITH(merge(body, {{}, {0}}), says("no element is split into Quad4"));
    CHECK_THROWS_WITH(split(body, {{}, {99}}), says("no Quad4 element 99"));
    CHECK_THROWS_WITH(split(body, {{0}}), says("1 element types, but the mesh has 2"));
    CHECK_THROWS_WITH(split(body, {{}, {0}}, {.triangles = 3}), says("3 triangles; give 2 or 4"));
    set_mesh_limits(body, {.nodes = nodes.size() + 1});
    CHECK_THROWS_WITH(split(body, {{}, {0, 1, 2, 3}}),
                      says("to split 4 cells") && says("the limit is"));
    CHECK(body.mesh().nodes == nodes);
    auto plain = body_of<typename Plane::Whole>(backend, distorted_mesh<Quad4>(2));
    CHECK_THROWS_WITH(split(plain, {{0}}), says("the mesh has no Tri3"));
  });
}

}  // namespace pliant::test::shape_suite
