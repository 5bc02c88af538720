#pragma once

#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/newton.hpp>

#include "support/formulations.hpp"

// One element under a prescribed motion: what its quadrature points remember follows from the strain's
// history in closed form.
namespace pliant::test::internal_variables_suite {

template <template <class> class L>
using OneSquare = Formulation<Quad4, Gauss<2>, L>;

inline Mesh<Quad4> unit_square() { return mesh::rectangle({.size = {1, 1}, .cells = {1, 1}}); }

/// The force on the side x = 1 while the square is stretched along x by `stretch(t)`, confined.
template <class TheBody>
double pull(TheBody& body) {
  auto const f = body.forces();
  return -f[1][0] - f[3][0];
}
template <class TheBody, class Stretch>
void confine(TheBody& body, Stretch const& stretch) {
  body.hold(std::vector<Index>{0, 2}, all_directions<2>);
  body.drive(std::vector<Index>{1, 3}, [=](double t) { return Point<2>{stretch(t), 0}; });
}

TEST_CASE("a stretch that is held relaxes as the Prony series does", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using F = OneSquare<Prony<SaintVenantKirchhoff, 2>::template law>;
    typename F::template law<double> const law{{3, 2}, {0.5, 0.25}, {0.1, 1}};
    double const h = 0.2, e = h + h * h / 2, s = (3 + 4) * e;  // S₁₁ of the elastic law
    auto body = Body{backend, unit_square(), soft, Group<F>{law}};
    confine(body, [h](double t) { return t > 0 ? h : 0.0; });
    CentralDifference step{{.step = 1e-3}};

    for (int tenths = 1; tenths <= 10; ++tenths) {
      step(body, tenths == 1 ? 101 : 100);  // the first step stretches
      double const t = 0.1 * tenths;
      // Taken up within the first step, each branch by its mean decay over it.
      auto const branch = [t](double share, double tau) {
        double const x = 1e-3 / tau;
        return share * (1 - std::exp(-x)) / x * std::exp(-t / tau);
      };
      double const expected = (1 + h) * s * (1 + branch(0.5, 0.1) + branch(0.25, 1));
      CHECK(pull(body) == Approx(expected).epsilon(sizeof(typename B::scalar) == 4 ? 2e-4 : 1e-11));
    }
  });
}

TEST_CASE("a dashpot pulls in proportion to the rate", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using F = OneSquare<KelvinVoigt<SaintVenantKirchhoff>::template law>;
    typename F::template law<double> const law{{3, 2}, 0.5};
    auto body = Body{backend, unit_square(), soft, Group<F>{law}};
    double const rate = 0.4, dt = 1e-3;
    confine(body, [rate](double t) { return rate * t; });
    CentralDifference step{{.step = dt}};
    step(body, 500);
    double const h = rate * body.time(), before = h - rate * dt;
    double const strain = h + h * h / 2, strain_before = before + before * before / 2;

    double const expected = (1 + h) * (7 * strain + 0.5 * (strain - strain_before) / dt);

    CHECK(pull(body) == Approx(expected).epsilon(sizeof(typename B::scalar) == 4 ? 1e-3 : 1e-11));
  });
}

TEST_CASE(
    "an element that changes its elastic law keeps its past, and one without a past begins relaxed",
    "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using A = OneSquare<Prony<SaintVenantKirchhoff>::template law>;
    using C = OneSquare<Prony<NeoHookean>::template law>;
    using Elastic = OneSquare<SaintVenantKirchhoff>;
    typename A::template law<double> const first{{3, 2}, {0.5}, {10}};
    typename C::template law<double> const second{{3, 2}, {0.5}, {10}};
    auto const stretched = [&] {
      Body body{backend, unit_square(), soft, Group<A>{first}, Group<C>{second}, Group<Elastic>{}};
      confine(body, [](double t) { return t > 0 ? 0.1 : 0.0; });
      CentralDifference step{{.step = 1e-2}};
      step(body, 3);
      return body;
    };
    SECTION("kept") {
      auto body = stretched();
      double const x = 1e-2 / 10, decay = std::exp(-x);
      double const branch = 0.5 * (1 - decay) / x * 7 * 0.105;  // Q₁₁, as the first law loaded it
      CHECK(pull(body) == Approx(1.1 * (7 * 0.105 + square(decay) * branch)).epsilon(1e-12));
      body.template assign<C>({0});
      double const elastic = 2 * (1.1 - 1 / 1.1) + 3 * std::log(1.1) / 1.1;
      // The jump of the elastic stress is no deformation: it loads no branch.
      CHECK(pull(body) == Approx(elastic + 1.1 * square(decay) * branch).epsilon(1e-12));
      CentralDifference{{.step = 1e-2}}(body, 2);
      CHECK(pull(body) == Approx(elastic + 1.1 * std::exp(-4 * x) * branch).epsilon(1e-12));
    }
    SECTION("kept by a rule") {
      auto body = stretched();
      double const x = 1e-2 / 10, decay = std::exp(-x);
      double const branch = 0.5 * (1 - decay) / x * 7 * 0.105;
      Adaptation soften{when<A>(EdgeLengthRatio{}).above(0.01).template become<C>()};
      soften.now(body);
      REQUIRE(body.template groups_of<Quad4>()[0] == 1);
      double const elastic = 2 * (1.1 - 1 / 1.1) + 3 * std::log(1.1) / 1.1;
      CHECK(pull(body) == Approx(elastic + 1.1 * square(decay) * branch).epsilon(1e-12));
    }
    SECTION("begun by a rule") {
      auto body = stretched();
      body.template assign<Elastic>({0});
      Adaptation soften{when<Elastic>(EdgeLengthRatio{}).above(0.01).template become<A>()};
      soften.now(body);
      REQUIRE(body.template groups_of<Quad4>()[0] == 0);
      CHECK(pull(body) == Approx(1.1 * 7 * 0.105).epsilon(1e-12));
    }
    SECTION("begun") {
      auto body = stretched();
      body.template assign<Elastic>({0});
      double const elastic = pull(body);
      CHECK(elastic == Approx(1.1 * 7 * 0.105).epsilon(1e-12));
      body.template assign<A>({0});
      CHECK(pull(body) == Approx(elastic).epsilon(1e-12));
    }
  });
}

TEST_CASE("a static solution is at rest with its memory", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Maxwell = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::template law>;
    using Dashpot = Formulation<Tri3, Gauss<1>, KelvinVoigt<NeoHookean>::template law>;
    auto const rests = [&]<class F>(Group<F> const& group) {
      auto const mesh = distorted_mesh<typename F::element>(4);
      Body body{backend, mesh, soft, group};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -0.3});
      CentralDifference step{{.step = 2e-3}};
      step(body, 50);  // a past to be forgotten
      body.set_velocities(FieldOf<2>(mesh.nodes.size()));

      solve_static(body);

      auto const u = body.displacements();
      auto left = body.forces();
      for (std::size_t i = 0; i < left.size(); ++i)
        left[i][1] -= 0.3 * body.parts().layout.mass_list()[i];
      for (Index i : nodes_of(mesh.boundary("left"))) left[static_cast<std::size_t>(i)] = {};
      CHECK(largest(left) < 1e-11);
      step(body, 200);
      CHECK(largest(u) > 0.01);
      CHECK(difference(body.displacements(), u) < 1e-9 * largest(u));
    };
    rests(Group<Maxwell>{typename Maxwell::template law<double>{{3, 2}, {0.5}, {10}}});
    rests(Group<Dashpot>{typename Dashpot::template law<double>{{3, 2}, 0.05}});
  });
}

TEST_CASE("what a static solution brings to rest is booked", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Maxwell = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::template law>;
    auto const mesh = distorted_mesh<Quad4>(4);
    Body body{backend, mesh, soft,
              Group<Maxwell>{typename Maxwell::template law<double>{{3, 2}, {0.5}, {10}}}};
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, -0.3});
    CentralDifference step{{.step = 2e-3}};
    step(body, 50);
    auto const unbooked = [&] {
      return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
    };
    double const before = unbooked(), size = strain_energy(body) + kinetic_energy(body);

    solve_static(body);

    CHECK(std::abs(unbooked() - before) < 1e-9 * size);
    CHECK(std::abs(external_work(body).by_hand) > 0.01 * size);
  });
}

TEST_CASE("what branches store comes back without a false alarm", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::template law>;
    auto const mesh = regular_mesh<Quad4>(4);
    Body body{backend, mesh, soft,
              Group<F>{typename F::template law<double>{{3, 2}, {0.5}, {100}}}};
    auto stretch = Tensor<double, 2>::zero();
    stretch(0, 0) = 0.2;
    body.set_displacements(uniform(mesh.nodes, stretch));
    double const before = total_energy(body);
    CentralDifference step{{.check_interval = 10}};
    double most = before;

    for (int k = 0; k < 200; ++k) {
      step(body);
      most = std::max(most, total_energy(body));
    }

    CHECK(step.retries() == 0);
    CHECK(most > 1.2 * before);  // half as much again lies in the branches
    CHECK(most < 1.51 * before);
  });
}

TEST_CASE("going back to a checkpoint goes back in memory too", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, Prony<NeoHookean>::template law>;
    auto const mesh = distorted_mesh<Tri3>(6);
    Body body{backend, mesh, soft, Group<F>{typename F::template law<double>{{3, 2}, {1}, {0.05}}}};
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, -0.5});
    auto const advance = [&](int steps) { take_steps(body.parts(), 2e-3, steps); };
    advance(100);
    keep_checkpoint(body.parts());
    advance(100);
    auto const once = body.displacements();
    roll_back(body.parts());
    advance(100);
    double const rounding = sizeof(typename B::scalar) == 4 ? 1e-5 : 1e-12;
    CHECK(difference(body.displacements(), once) < rounding * largest(once));
    CHECK(largest(once) > 1e-3);
  });
}

TEST_CASE("the stable step is stable with dashpots, and not far from the limit", "[body]") {
  MainBackend const backend;
  using F = Formulation<Quad4, Gauss<2>, KelvinVoigt<SaintVenantKirchhoff>::template law>;
  double last = 1;
  for (double viscosity : {0.0, 0.01, 0.1, 1.0}) {
    auto const mesh = distorted_mesh<Quad4>(5);
    Body body{backend, mesh, soft, Group<F>{typename F::template law<double>{{3, 2}, viscosity}}};
    body.clamp(mesh.boundary("left"));
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 1e-3));
    double const step = stable_step(body), energy = total_energy(body);
    INFO("viscosity " << viscosity << " Pa s, step " << step << " s");
    CHECK(step < last);
    last = step;
    take_steps(body.parts(), step, 2000);
    CHECK(total_energy(body) < 1.5 * energy);
    // Nor is it timid: three times the step explodes.
    take_steps(body.parts(), 3 * step, 400);
    CHECK(!(total_energy(body) < 100 * energy));
  }
}

TEST_CASE("viscosity takes energy from a vibration", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Quad4, Gauss<2>, KelvinVoigt<SaintVenantKirchhoff>::template law>;
    auto const energy_left = [&](double viscosity) {
      auto const mesh = distorted_mesh<Quad4>(5);
      Body body{backend, mesh, soft, Group<F>{typename F::template law<double>{{3, 2}, viscosity}}};
      body.clamp(mesh.boundary("left"));
      auto shear = Tensor<double, 2>::zero();
      shear(1, 0) = 0.2;
      body.set_velocities(uniform(mesh.nodes, shear));
      double const before = total_energy(body);
      CentralDifference step{{.step = 2e-3, .energy_growth = 0.01}};
      step(body, 1000);
      return total_energy(body) / before;
    };
    CHECK(energy_left(0) == Approx(1).epsilon(1e-3));
    CHECK(energy_left(0.05) < 0.9);
    CHECK(energy_left(0.2) < energy_left(0.05));
  });
}

}  // namespace pliant::test::internal_variables_suite
