#pragma once

#include <memory>

#include "stability/runner.hpp"

// Bodies that change their law, rule, mesh or sleep on the way, and those whose stiffness differs between elements.
namespace pliant::stability {

template <class B, Element E>
struct Special {
  using Fine = Gauss<SimplexCell<typename E::cell> ? E::degree + 1 : E::degree + 2>;
  using Cheap = Formulation<E, Full<E>, SaintVenantKirchhoff>;
  using Rubber = Formulation<E, Full<E>, NeoHookean>;
  using FineRubber = Formulation<E, Fine, NeoHookean>;
  using Graded = Formulation<E, Full<E>, PerElement<NeoHookean>::template law>;

  /// Elements of the right half are 1e6 times as stiff as the material.
  static std::vector<std::array<double, 2>> graded_values(Mesh<E> const& mesh,
                                                          Elastic const& material) {
    auto const law = NeoHookean<double>::from(material);
    std::vector<std::array<double, 2>> values;
    for (auto const& element : mesh.template elements<E>()) {
      double middle = 0;
      for (Index node : element) middle += mesh.nodes[static_cast<std::size_t>(node)][0] / E::nodes;
      double const factor = middle > 0.5 ? 1e6 : 1;
      values.push_back({factor * law.lambda, factor * law.mu});
    }
    return values;
  }

  static Record run(Scene const& scene, Replay const& replay) {
    Adaptation rest{sleep({.below = 0.5, .for_steps = 1})};
    Adaptation protect{when<Cheap>(Compression{}).above(0.15).template become<Rubber>()};
    auto const make = [&](Elastic const& material) {
      auto const mesh = mesh_of<E>(scene);
      Body body{B{},
                mesh,
                material,
                Group<Cheap>{},
                Group<Rubber>{},
                Group<FineRubber>{},
                Group<Graded>{.values = graded_values(mesh, material)}};
      auto const all = all_elements<E>(body);
      if (scene.law == "graded NeoHookean") body.template assign<Graded>(all);
      if (scene.law == "NeoHookean") body.template assign<Rubber>(all);
      return body;
    };
    auto const between = [&](auto& body, int k) {
      bool const odd = k % 2 == 1;
      auto const all = all_elements<E>(body);
      switch (scene.toggle) {
        case Toggle::none:
          break;
        case Toggle::law:
          odd ? body.template assign<Rubber>(all) : body.template assign<Cheap>(all);
          break;
        case Toggle::quadrature:
          odd ? body.template assign<FineRubber>(all) : body.template assign<Rubber>(all);
          break;
        case Toggle::mesh:
          if (odd)
            refine(body, {{all.front(), all[all.size() / 2]}}, 1);
          else
            coarsen(body, {all});
          break;
        case Toggle::sleep:
          // Everything that is slow falls asleep, and is woken by a load.
          if (odd)
            rest(body);
          else
            body.set_gravity(lowered<E::dim>(scene.gravity));
          break;
        case Toggle::protective:
          protect(body);
          break;
      }
    };
    return run_scene(scene, replay, make, between);
  }
};

template <class B, Element E>
bool add_special() {
  constexpr bool in_double = std::same_as<typename B::scalar, double>;
  special_bodies().push_back(
      {.element = E::name(),
       .backend = std::string(B::name()) + (in_double ? " double" : " float"),
       .dim = E::dim,
       .degree = E::degree,
       .simplex = SimplexCell<typename E::cell>,
       .in_double = in_double,
       .reference = std::same_as<B, Reference<double>>,
       .laws = {{"SaintVenantKirchhoff", true, true},
                {"NeoHookean", false, true},
                {"graded NeoHookean", false, true}},
       .run = &Special<B, E>::run});
  return true;
}

}  // namespace pliant::stability
