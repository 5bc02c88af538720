#pragma once

#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>

#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/implicit.hpp>

#include "adaptation/changes_on_backend.hpp"

// Bodies that are refined and coarsened at random in their backend's memory, beside bodies that the host changes, while their state,
// groups, conditions and limits change, they step, fall asleep, and are saved and loaded.
// PLIANT_CHANGES in the environment: how many actions; 60 unless set.
namespace pliant::test::storm_on_backend_suite {
using namespace two_bodies;

/// The same on both, and that they do the same: f(body), whose results or errors have to agree.
template <class Both, class F>
void on_both(Both& both, F const& f) {
  auto const result = [&](auto& body) -> std::string {
    try {
      std::ostringstream words;
      words << f(body);
      return words.str();
    } catch (Error const& error) {
      return error.what();
    }
  };
  CHECK(result(both.body) == result(both.host));
}

/// The strain along x of an element.
struct Longer {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.gradient()(0, 0);
  }
};

/// Actions at random on a body that its backend changes and on one that the host changes.
template <class F, class B>
class Storm {
  static constexpr int dim = F::element::dim;

 public:
  Storm(B const& backend, Index cells) : both_(backend, cells), random_(8) {}

  void one_action() {
    std::size_t const action = random_.below(18);
    INFO("action " << action);
    switch (action) {
      case 0:
      case 1:
        return refine_or_coarsen(2 + random_.below(8), 1u << 20);
      case 2:
      case 3:
        return refine_or_coarsen(0, 1 + random_.below(12));
      case 4:
        return refine_or_coarsen(4 + random_.below(12), 6);
      case 5:
        return assign();
      case 6:
        return step();
      case 7:
        return displace();
      case 8:
        return hold();
      case 9:
        return release();
      case 10:
        return save_and_load();
      case 11:
        return exceed_a_limit();
      case 12:
        return set_loads();
      case 13:
        return fall_asleep();
      case 14:
        return become_still();
      case 15:
      case 16:
        return adapt();
      default:
        return press();
    }
  }
  void check() {
    both_.check_all();
    go_on_alike();
  }
  [[nodiscard]] int changed_there() const { return changed_there_; }

 private:
  void go_on_alike() {
    auto const u = both_.host.displacements(), v = both_.host.velocities();
    for (auto* one : {&both_.body, &both_.host}) {
      one->set_displacements(u);
      one->set_velocities(v);
    }
  }
  std::vector<Index> some_nodes(std::size_t one_in) {
    std::vector<Index> nodes;
    for (Index node = 0; node < both_.host.nodes(); ++node)
      if (random_.below(one_in) == 0) nodes.push_back(node);
    return nodes;
  }

  /// Refines one in so many, if any, and coarsens the others but for one in so many.
  void refine_or_coarsen(std::size_t refined, std::size_t left) {
    MarkedElements marked{.refine = {{}}, .coarsen = {{}}};
    for (Index e = 0; e < count(both_.host); ++e)
      if (refined > 0 && random_.below(refined) == 0)
        marked.refine[0].push_back(e);
      else if (left < 1u << 20 && random_.below(left) != 0)
        marked.coarsen[0].push_back(e);
    on_both(both_, [&](auto& body) {
      std::size_t changed = 0;
      if (marked.coarsen[0].empty()) {
        changed = refine(body, marked.refine, 3).refined;
      } else if (marked.refine[0].empty()) {
        changed = coarsen(body, marked.coarsen).merged;
      } else if (auto const done = detail::change_on_backend(
                     body.parts(), {.refine = marked.refine, .coarsen = marked.coarsen}, 3)) {
        changed = done->counts.refined + done->counts.coarsened;
        tell_listeners(body.parts(), done->to_tell);
      } else if (auto const plan = plan_change(body.parts(), marked, 3)) {
        changed = plan->counts.refined + plan->counts.coarsened;
        merge_and_refine(body, marked.refine[0], *plan);
      }
      if (changed > 0) changed_there_ += is_on_backend(body);
      // That what came before all that goes stays where it is, though it is not much.
      if (is_on_backend(body))
        body.parts().topology_on->tree.few = std::numeric_limits<Index>::min();
      return changed;
    });
  }
  /// Does what a plan does in two changes, as a backend does, where nodes may come to hang in between.
  template <class TheBody, class Plan>
  static void merge_and_refine(TheBody& body, std::vector<Index> const& refined, Plan const& plan) {
    auto& parts = body.parts();
    MarkedElements merging{.coarsen = {{}}}, refining{.refine = {refined}};
    for (auto const& family : plan.transfer.families())
      if (family.after.size() == 1)
        for (auto const& member : family.before) merging.coarsen[0].push_back(member.element);
    auto const merged = plan_change(std::as_const(parts), merging, 3);
    if (merged) {
      std::vector<int> is_refined(at(count(body)));
      for (Index const e : refined) is_refined[at(e)] = 1;
      is_refined = merged->transfer.carry_elements(is_refined);
      refining.refine[0].clear();
      for (std::size_t e = 0; e < is_refined.size(); ++e)
        if (is_refined[e] != 0) refining.refine[0].push_back(static_cast<Index>(e));
      commit(parts, *merged);
    }
    auto const rest = plan_change(std::as_const(parts), refining, 3);
    if (!rest) return;
    commit(parts, *rest);
    if (!merged) return;
    auto& entries = parts.state.record.refinements;
    auto both = entries.take_back();
    auto const first = entries.take_back();
    both.action = "refine and coarsen";
    both.elements += first.elements;
    both.strain_energy += first.strain_energy;
    both.kinetic_energy += first.kinetic_energy;
    for (std::size_t k = 0; k < dim; ++k) both.impulse[k] += first.impulse[k];
    entries.push_back(std::move(both));
  }
  void assign() {
    auto const elements = some(both_.host, 3, random_);
    bool const stiffer = random_.below(2) == 0;
    on_both(both_, [&](auto& body) {
      stiffer ? body.template assign<Stiffer<F>>(elements) : body.template assign<F>(elements);
      return 0;
    });
  }
  void step() {
    double const dt = 0.05 * stable_step(both_.host);
    auto const kind = random_.below(4);
    on_both(both_, [&](auto& body) {
      if (kind == 0)
        LocalSteps({.macro_step = 8 * dt})(body, 1);
      else if (kind == 1)
        Implicit{Newmark{}, {.step = dt}}(body, 1);
      else
        CentralDifference({.step = dt})(body, 2);
      return body.steps();
    });
    // What solvers leave is larger than rounding.
    CHECK(largest_difference(both_.body.displacements(), both_.host.displacements()) <
          (kind == 1 ? 1e-6 : 1000 * both_.rounding));
    if constexpr (internal_variables_of<F> > 0) {
      auto const& of_host = both_.host.parts();
      auto& of_body = both_.body.parts();
      auto const kept = std::get<0>(of_host.layout.tables)
                            .in_user_order(std::get<0>(of_host.state.elements).internal_variables);
      std::get<0>(of_body.state.elements)
          .internal_variables.upload(std::get<0>(of_body.layout.tables).in_internal_order(kept));
    }
    go_on_alike();
    settle_down();
  }
  /// At times, so that what is unstable does not grow without end.
  void settle_down() {
    if (random_.below(2) == 0) displace();
  }
  /// Near a smooth field, from wherever they were.
  void displace() {
    std::vector<Point<dim>> u(at(both_.host.nodes()));
    for (std::size_t i = 0; i < u.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        u[i][k] = 0.05 * std::sin(2 * both_.host.mesh().nodes[i][(k + 1) % dim]) +
                  1e-3 * (random_() - 0.5);
    for (auto* one : {&both_.body, &both_.host}) {
      one->set_displacements(u);
      one->set_velocities(std::vector<Point<dim>>(u.size(), u[0]));
    }
  }
  void hold() {
    if (handles_.size() > 5) return release();  // some nodes are to stay free
    auto const nodes = some_nodes(15);
    auto const directions = static_cast<DirectionMask>(1 + random_.below((1u << dim) - 1));
    bool const drives = random_.below(2) == 0;
    on_both(both_, [&](auto& body) {
      auto const handle =
          drives ? body.drive(nodes, drawn<dim>, {.directions = directions, .name = "drawn"})
                 : body.hold(nodes, directions);
      if (&body == &both_.host) handles_.push_back(handle);
      return 0;
    });
  }
  void press() {
    auto const& boundary = both_.host.mesh().boundary(random_.below(2) == 0 ? "top" : "right");
    double const pascals = 0.1 * random_();
    on_both(both_, [&](auto& body) {
      auto const handle = body.press(boundary, pascals);
      if (&body == &both_.host) handles_.push_back(handle);
      return 0;
    });
  }
  void release() {
    if (handles_.empty()) return;
    auto const which = random_.below(handles_.size());
    on_both(both_, [&](auto& body) {
      body.release(handles_[which]);
      return 0;
    });
    handles_.erase(handles_.begin() + static_cast<std::ptrdiff_t>(which));
  }
  void save_and_load() {
    std::stringstream saved(std::ios::in | std::ios::out | std::ios::binary);
    auto& from = random_.below(2) == 0 ? both_.body : both_.host;
    from.save(saved);
    auto const written = saved.str();
    on_both(both_, [&](auto& body) {
      std::stringstream own(written, std::ios::in | std::ios::binary);
      body.load(own);
      return body.nodes();
    });
    change_on_host(both_.host);
  }
  void exceed_a_limit() {
    auto const marked = some(both_.host, 2, random_);
    auto const nodes = static_cast<std::size_t>(both_.host.nodes()) + 1;
    on_both(both_, [&](auto& body) {
      set_mesh_limits(body, {.nodes = nodes});
      return refine(body, {marked}, 3).refined;
    });
    for (auto* one : {&both_.body, &both_.host}) set_mesh_limits(*one, {});
  }
  void set_loads() {
    std::vector<Point<dim>> loads(at(both_.host.nodes()));
    for (auto& load : loads)
      for (double& x : load) x = 1e-3 * (random_() - 0.5);
    on_both(both_, [&](auto& body) {
      body.set_loads(loads);
      return 0;
    });
  }
  /// By rules, from rest, where both bodies are the same to the bit.
  void adapt() {
    become_still();
    double const limit = 0.05 * random_();
    bool const refines = random_.below(2) == 0;
    on_both(both_, [&](auto& body) {
      auto const before = count(body);
      if (refines)
        Adaptation{when<F>(Longer{}).above(limit).refine({.max_level = 2}),
                   when<F>(Longer{}).below(-limit).template become<Stiffer<F>>()}
            .now(body);
      else
        Adaptation{when<F>(Longer{}).below(limit).coarsen(),
                   when<Stiffer<F>>(Longer{}).below(limit).coarsen(),
                   when<Stiffer<F>>(Longer{}).above(limit).template become<F>()}
            .now(body);
      if (count(body) != before) changed_there_ += is_on_backend(body);
      return count(body);
    });
  }
  void become_still() {
    on_both(both_, [&](auto& body) {
      body.set_velocities(std::vector<Point<dim>>(at(body.nodes())));
      return 0;
    });
  }
  void fall_asleep() {
    become_still();
    double const dt = 0.01 * stable_step(both_.host);
    on_both(both_, [&](auto& body) {
      CentralDifference steps({.step = dt});
      auto rest = Adaptation{sleep({.below = 1e9, .for_steps = 1})}.every(1);
      steps(body, 3, rest);
      return asleep(body).patches;
    });
    go_on_alike();
    settle_down();
  }

  TwoBodies<F, B> both_;
  Random random_;
  std::vector<Handle> handles_;
  int changed_there_ = 0;
};

TEST_CASE(
    "bodies that change at random in their backend's memory stay as those that the host changes",
    "[adaptation]") {
  char const* const wanted = std::getenv("PLIANT_CHANGES");
  int const actions = wanted != nullptr ? std::atoi(wanted) : 60;
  REQUIRE(actions > 0);
  on_each_backend<KeepingBackends>([&]<class B>(B const& backend) {
    int changed_there = 0;
    auto const run = [&]<class F>(F, Index cells) {
      Storm<F, B> storm(backend, cells);
      for (int i = 0; i < actions; ++i) {
        INFO("element " << F::element::name() << ", action number " << i);
        storm.one_action();
        if (i % 4 == 3) storm.check();
      }
      storm.check();
      changed_there += storm.changed_there();
    };
    run(Formulation<Tri3, Gauss<1>, NeoHookean>{}, 4);
    run(Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>{}, 3);
    run(Formulation<Tet4, Gauss<1>, NeoHookean>{}, 2);
    run(Formulation<Hex8, Gauss<2>, NeoHookean>{}, 2);
    run(Formulation<Tri6, Gauss<3>, NeoHookean>{}, 3);
    CAPTURE(changed_there);
    CHECK(changed_there > actions / 2);
  });
}

}  // namespace pliant::test::storm_on_backend_suite
