#pragma once

#include "storm/storm.hpp"

namespace pliant::storm {

inline constexpr Elastic soft{5.2, 0.3, 1.5};

/// Some of `count` elements.
inline std::vector<Index> some(Index count, std::size_t one_in, test::Random& random) {
  std::vector<Index> list;
  for (Index e = 0; e < count; ++e)
    if (random.below(one_in) == 0) list.push_back(e);
  return list;
}
template <Element E, class TheBody>
std::vector<Index> some_of(TheBody const& body, std::size_t one_in, test::Random& random) {
  return some(static_cast<Index>(body.mesh().template elements<E>().size()), one_in, random);
}

/// All elements but some.
template <Element E, class TheBody>
std::vector<Index> most_of(TheBody const& body, test::Random& random) {
  std::vector<Index> list;
  for (Index e = 0; e < static_cast<Index>(body.mesh().template elements<E>().size()); ++e)
    if (random.below(50) != 0) list.push_back(e);
  return list;
}

/// Triangles and quadrilaterals of two and three laws, refined and coarsened as they go.
template <Backend B>
struct Plane {
  using TriLinear = Formulation<Tri3, Gauss<1>, Hooke>;
  using TriRubber = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
  using Middle = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
  using body_type = Body<B, Mesh<Tri3, Quad4>, TriRubber, TriLinear, Rubber, Middle, Linear>;

  B backend{};
  unsigned seed = 1;
  int cells = 5;  // along an edge

  body_type body() const {
    body_type made{backend,
                   test::mixed_mesh(cells, seed),
                   soft,
                   Group<TriRubber>{},
                   Group<TriLinear>{},
                   Group<Rubber>{},
                   Group<Middle>{},
                   Group<Linear>{}};
    set_mesh_limits(made, {.nodes = most_nodes()});
    return made;
  }
  std::size_t most_nodes() const { return static_cast<std::size_t>(6 * cells * cells); }
  void switch_groups(body_type& body) const {
    static Adaptation rules{when<TriLinear>(Rotation{}).above(0.02).template become<TriRubber>(),
                            when<TriRubber>(Rotation{}).below(0.01).template become<TriLinear>(),
                            when<Linear>(Rotation{}).above(0.01).template become<Middle>(),
                            when<Middle>(Rotation{}).above(0.03).template become<Rubber>(),
                            when<Rubber>(Rotation{}).below(0.02).template become<Middle>(),
                            when<Middle>(Rotation{}).below(0.005).template become<Linear>()};
    rules(body);
  }
  void make_finer(body_type& body) const {
    static Adaptation finer = Adaptation{when<TriRubber>(ForceIntensity<>{})
                                             .above_fraction_of_largest(0.98)
                                             .refine({.max_level = 2})}
                                  .every(60);
    if (body.nodes() < static_cast<Index>(most_nodes() - most_nodes() / 5)) finer(body);
  }
  void refine(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    if (random.below(2) == 0) {
      pliant::coarsen(body, {most_of<Tri3>(body, random), most_of<Quad4>(body, random)});
      return;
    }
    auto triangles = some_of<Tri3>(body, 30, random);
    pliant::refine(body, {triangles, some_of<Quad4>(body, 30, random)}, 2);
  }
  void assign(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    body.template assign<TriLinear>(some_of<Tri3>(body, 10, random));
    body.template assign<Rubber>(some_of<Quad4>(body, 10, random));
    body.template assign<Middle>(some_of<Quad4>(body, 20, random));
  }
};

/// Plane elements whose degree goes up and down, and which are split into triangles and merged, beside refinement.
template <Backend B>
struct Types {
  using Low = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Triangles = Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>;
  using High = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
  using HighRubber = Formulation<Quad9, Gauss<3>, NeoHookean>;
  using body_type = Body<B, Mesh<Quad4, Tri3, Quad9>, Low, Triangles, High, HighRubber>;

  B backend{};
  unsigned seed = 1;
  int cells = 4;  // along an edge

  body_type body() const {
    body_type made{backend,
                   mesh::with_types<Quad4, Tri3, Quad9>(test::distorted_mesh<Quad4>(cells, seed)),
                   soft,
                   Group<Low>{},
                   Group<Triangles>{},
                   Group<High>{},
                   Group<HighRubber>{}};
    set_mesh_limits(made, {.nodes = static_cast<std::size_t>(30 * cells * cells)});
    return made;
  }
  void switch_groups(body_type& body) const {
    static Adaptation rules =
        Adaptation{when<High>(Rotation{}).above(0.02).template become<HighRubber>(),
                   when<HighRubber>(Rotation{}).below(0.01).template become<High>()}
            .every(5);
    rules(body);
  }
  void make_finer(body_type& body) const {
    static Adaptation types =
        Adaptation{when<Low>(StrainNorm{}).top_share(0.05).raise({.ring = 1}),
                   when<Low>(StrainNorm{}).below(0.002).split({.triangles = 2}),
                   when<Triangles>(StrainNorm{}).above(0.01).merge(),
                   when<High>(StrainNorm{}).below(0.001).lower()}
            .every(40);
    if (body.nodes() < static_cast<Index>(15 * cells * cells)) types(body);
  }
  void refine(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    switch (random.below(6)) {
      case 0:
        pliant::coarsen(body, {most_of<Quad4>(body, random), most_of<Tri3>(body, random),
                               most_of<Quad9>(body, random)});
        break;
      case 1:
        pliant::raise(body, {some_of<Quad4>(body, 5, random), {}, {}},
                      {.ring = static_cast<int>(random.below(2))});
        break;
      case 2:
        pliant::lower(body, {{}, {}, some_of<Quad9>(body, 3, random)});
        break;
      case 3:
        pliant::split(body, {some_of<Quad4>(body, 4, random), {}, {}},
                      {.triangles = random.below(2) == 0 ? 2 : 4});
        break;
      case 4:
        pliant::merge(body, {{}, most_of<Tri3>(body, random), {}});
        break;
      default: {
        auto linear = some_of<Quad4>(body, 8, random);
        auto triangles = some_of<Tri3>(body, 12, random);
        pliant::refine(body, {linear, triangles, some_of<Quad9>(body, 10, random)}, 2);
      }
    }
  }
  void assign(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    body.template assign<HighRubber>(some_of<Quad9>(body, 10, random));
  }
};

/// Solid elements of two laws, refined and coarsened as they go; those without internal variables switch between them.
template <Backend B, Element E, template <class> class Second>
struct Solid {
  using First = Formulation<E, Gauss<E::cell::corners == 4 ? 1 : 2>, SaintVenantKirchhoff>;
  using Other = Formulation<E, Gauss<E::cell::corners == 4 ? 1 : 2>, Second>;
  using body_type = Body<B, Mesh<E>, First, Other>;

  B backend{};
  Group<Other> other{};
  unsigned seed = 1;
  int cells = 4;  // along an edge

  body_type body() const {
    body_type made{backend, test::distorted_mesh<E>(cells, seed), soft, Group<First>{}, other};
    set_mesh_limits(made, {.nodes = static_cast<std::size_t>(5 * cells * cells * cells)});
    return made;
  }
  void switch_groups(body_type& body) const {
    static Adaptation rules =
        Adaptation{when<First>(Rotation{}).above(0.02).template become<Other>(),
                   when<Other>(Rotation{}).below(0.01).template become<First>()}
            .every(5);
    rules(body);
  }
  void make_finer(body_type&) const {}
  void refine(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    if (random.below(2) == 0)
      pliant::coarsen(body, {most_of<E>(body, random)});
    else
      pliant::refine(body, {some_of<E>(body, 60, random)}, 1);
  }
  void assign(body_type& body, unsigned seed_of_marks) const {
    test::Random random(seed_of_marks);
    body.template assign<First>(some_of<E>(body, 10, random));
    body.template assign<Other>(some_of<E>(body, 10, random));
  }
};

}  // namespace pliant::storm
