#pragma once

#include <sstream>

#include <Eigen/Dense>

#include <pliant/body/compare.hpp>
#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/implicit.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/flat.hpp"
#include "support/random.hpp"
#include "support/repeatable.hpp"

// The schemes of implicit integration beside their formulas in dense matrices, and what they share: linear solvers
// with and without a matrix, steps that follow their error, stiffness damping, laws with internal variables.
namespace pliant::test::schemes_suite {

using Eigen::VectorXd;
using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Gel = Formulation<Quad4, Gauss<2>, KelvinVoigt<NeoHookean>::law>;

template <class F, class B>
auto beam(B const& backend, Group<F> group = {}) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  Body body{backend, mesh, Elastic{1e5, 0.3, 1000}, group};
  body.clamp(mesh.boundary("left"));
  FieldOf<2> v;
  for (auto const& x : mesh.nodes) v.push_back({0, square(x[0])});
  body.set_velocities(v);
  return body;
}
template <class TheBody>
VectorXd vector_of(TheBody const&, FieldOf<2> const& field) {
  auto const list = flat<double>(field);
  return Eigen::Map<VectorXd const>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// M a + (c M + s K) v + K u = f of the free entries of a linear body.
struct Dense {
  Eigen::MatrixXd mass, stiffness, damping;
  VectorXd force, u, v, a;
  std::vector<Eigen::Index> free;

  template <class TheBody>
  Dense(TheBody& body, double c, double s) {
    auto const moves = body.state().prescribed->conditions[0].nodes;
    for (Index i = 0; i < body.nodes(); ++i)
      if (std::ranges::find(moves, i) == moves.end())
        for (int k = 0; k < 2; ++k) free.push_back(2 * i + k);
    Eigen::MatrixXd const all = assemble_mass(body);
    VectorXd gravity(all.rows());
    for (Eigen::Index i = 0; i < gravity.size(); ++i)
      gravity[i] = body.state().gravity[static_cast<std::size_t>(i % 2)];
    VectorXd const pull = all * gravity + vector_of(body, nodal_loads(body));
    mass = all(free, free);
    stiffness = Eigen::MatrixXd(assemble(body, VectorXd::Zero(all.rows())).stiffness)(free, free);
    damping = c * mass + s * stiffness;
    force = pull(free);
    u = vector_of(body, body.displacements())(free);
    v = vector_of(body, body.velocities())(free);
    a = mass.llt().solve(force - damping * v - stiffness * u);
  }
  void euler(double h) {
    Eigen::MatrixXd const all = mass + h * damping + h * h * stiffness;
    v = all.llt().solve(mass * v + h * (force - stiffness * u));
    u += h * v;
  }
  /// Chung and Hulbert's predictor and corrector, over the acceleration.
  void alpha(double h, double beta, double gamma, double of_inertia, double of_force) {
    VectorXd const coast = u + h * v + h * h * (0.5 - beta) * a, speed = v + h * (1 - gamma) * a;
    double const m = 1 - of_inertia, f = 1 - of_force;
    Eigen::MatrixXd const all = m * mass + f * gamma * h * damping + f * beta * h * h * stiffness;
    VectorXd const then =
        all.llt().solve(force - of_inertia * mass * a - damping * (f * speed + of_force * v) -
                        stiffness * (f * coast + of_force * u));
    u = coast + h * h * beta * then;
    v = speed + h * gamma * then;
    a = then;
  }
  /// Constant steps, as one step of the system of first order.
  void bdf(double h, VectorXd const& u_before, VectorXd const& v_before) {
    VectorXd const of_u = (4 * u - u_before) / 3, of_v = (4 * v - v_before) / 3;
    double const g = 2 * h / 3;
    Eigen::MatrixXd const all = mass + g * damping + g * g * stiffness;
    v = all.llt().solve(mass * of_v + g * (force - stiffness * of_u));
    u = of_u + g * v;
  }
};

TEST_CASE("each scheme takes the steps of its formulas", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const damping = GENERATE(0.0, 3e-3);
    auto const method = GENERATE(LinearMethod::direct, LinearMethod::matrix_free);
    double const h = 2e-3;
    auto const check = [&](auto const& scheme, auto const& take) {
      auto body = beam<Linear>(backend);
      body.set_gravity({1, -10});
      body.set_load(8, {0, 30});
      body.set_damping(2);
      Dense dense(body, 2, damping);
      Implicit step{
          scheme, {.step = h, .stiffness_damping = damping, .tolerance = 1e-12, .linear = method}};
      int factorisations = 0;
      for (int k = 0; k < 5; ++k) {
        take(dense, k);
        auto const report = step(body);
        CHECK(report.linear.method == method);
        factorisations += report.factorisations;
      }
      CHECK((method == LinearMethod::direct) == (factorisations > 0));
      VectorXd const u = vector_of(body, body.displacements())(dense.free),
                     v = vector_of(body, body.velocities())(dense.free);
      CAPTURE(scheme.name);
      CHECK((u - dense.u).norm() < 1e-9 * dense.u.norm());
      CHECK((v - dense.v).norm() < 1e-9 * dense.v.norm());
    };
    check(BackwardEuler{}, [&](Dense& dense, int) { dense.euler(h); });
    check(Newmark{}, [&](Dense& dense, int) { dense.alpha(h, 0.25, 0.5, 0, 0); });
    check(Newmark{0.36, 0.7}, [&](Dense& dense, int) { dense.alpha(h, 0.36, 0.7, 0, 0); });
    check(GeneralizedAlpha{0.5}, [&](Dense& dense, int) {
      dense.alpha(h, 4.0 / 9, 5.0 / 6, 0, 1.0 / 3);  // α_m = 0, α_f = 1/3
    });
    VectorXd u_before, v_before;
    check(BDF2{}, [&](Dense& dense, int k) {
      auto const u = dense.u, v = dense.v;
      if (k == 0)
        dense.euler(h);
      else
        dense.bdf(h, u_before, v_before);
      u_before = u;
      v_before = v;
    });
  });
}

auto stretched_square() {
  auto body = body_of<Rubber>(MainBackend{}, regular_mesh<Quad4>(3));
  body.set_displacements(uniform(body.mesh().nodes, Tensor<double, 2>{{{0.3, 0.1}, {0, -0.1}}}));
  return body;
}
template <class Scheme>
VectorXd end_of_swing(Scheme const& scheme, int steps, double uneven = 0) {
  auto body = stretched_square();
  double const h = 0.3 / steps;
  for (int k = 0; k < steps; ++k) {
    // Pairs of a longer and a shorter step.
    double const own = h * (1 + (k % 2 == 0 ? uneven : -uneven));
    Implicit{scheme, {.step = own, .tolerance = 1e-12}}(body);
  }
  return vector_of(body, body.displacements());
}

TEST_CASE("errors fall with the step as the order of each scheme says", "[solver]") {
  auto const ratio = [](auto const& scheme, double uneven = 0) {
    VectorXd const coarse = end_of_swing(scheme, 160, uneven),
                   middle = end_of_swing(scheme, 320, uneven),
                   fine = end_of_swing(scheme, 640, uneven);
    return (coarse - middle).norm() / (middle - fine).norm();
  };
  CHECK(ratio(BackwardEuler{}) == Approx(2).epsilon(0.1));
  CHECK(ratio(Newmark{}) == Approx(4).epsilon(0.1));
  CHECK(ratio(GeneralizedAlpha{0.5}) == Approx(4).epsilon(0.1));
  CHECK(ratio(BDF2{}) == Approx(4).epsilon(0.2));
  CHECK(ratio(BDF2{}, 0.3) == Approx(4).epsilon(0.2));
}

TEST_CASE("generalised alpha leaves the fastest modes what its spectral radius says", "[solver]") {
  for (double radius : {0.0, 0.5, 0.9, 1.0}) {
    auto body = body_of<Linear>(MainBackend{}, mesh::rectangle({.size = {1, 1}, .cells = {1, 1}}));
    body.clamp(std::vector<Index>{0, 1});
    body.set_displacements({{}, {}, {1e-3, 2e-3}, {-1e-3, 3e-3}});
    Implicit step{GeneralizedAlpha{radius}, {.step = 1e5}};
    step(body, 100);
    double const before = largest(body.displacements());
    step(body, 100);
    double const after = largest(body.displacements());
    if (radius == 0) {
      CHECK(before < 1e-15);
    } else {
      // Amplitudes fall as n² ρ^n, since all three roots are ρ.
      CHECK(std::pow(after / before, 0.01) == Approx(radius).epsilon(0.03));
    }
  }
}

TEST_CASE("steps without a matrix are those with one", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    bool const in_double = sizeof(typename B::scalar) == 8;
    auto const make = [&] {
      auto body = Body{backend, mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}),
                       Elastic{2e5, 0.3, 1000}, Group<QuadRubber>{}, Group<QuadLinear>{}};
      body.drive(body.mesh().boundary("left"), [](double t) {
        return Point<2>{0.01 * std::sin(40 * t), 0};
      });
      refine(body, {{3, 4}});
      body.set_gravity({0, -10});
      return body;
    };
    auto const kind = GENERATE(MassMatrix::consistent, MassMatrix::lumped);
    auto with = make(), without = make();
    REQUIRE(!with.state().topology->interpolation.empty());
    ImplicitOptions options{.step = 5e-3,
                            .mass = kind,
                            .stiffness_damping = 1e-3,
                            .tolerance = in_double ? 1e-12 : 1e-5};
    options.linear = LinearMethod::direct;
    auto const direct = Implicit{BDF2{}, options}(with, 10);
    options.linear = LinearMethod::matrix_free;
    auto const report = Implicit{BDF2{}, options}(without, 10);
    double const size = largest(with.displacements());
    CHECK(size > 1e-3);
    CHECK(difference(with.displacements(), without.displacements()) <
          (in_double ? 1e-9 : 1e-3) * size);
    CHECK(report.linear.iterations > 50);
    if (in_double) CHECK(report.iterations <= direct.iterations + 10);
    CHECK(report.factorisations == 0);
  });
}

TEST_CASE("iterations leave a free body its momentum, to rounding", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.5}, .cells = {8, 4}});
    Body body{backend, mesh, Elastic{2e5, 0.3, 1000}, Group<Rubber>{}};
    // Free along x; along y the left side is held.
    auto const left = nodes_of(mesh.boundary("left"));
    body.hold(left, 2);
    FieldOf<2> v;
    for (auto const& x : mesh.nodes) v.push_back({1 - 3 * x[0] + x[1] * x[0], 0.2 * x[0]});
    body.set_velocities(v);
    auto const momentum = [&] {
      double sum = 0;
      auto const now = body.velocities();
      for (std::size_t i = 0; i < now.size(); ++i)
        sum += body.parts().layout.mass_list()[i] * now[i][0];
      return sum;
    };
    double const before = momentum(), mass = 500;  // N s, kg

    // A tolerance that leaves errors well above rounding.
    ImplicitOptions options{.step = 4e-3, .tolerance = 1e-3};
    options.linear = GENERATE(LinearMethod::matrix_free, LinearMethod::multilevel);
    auto const report = Implicit{BackwardEuler{}, options}(body, 20);

    double const eps = std::numeric_limits<typename B::scalar>::epsilon();
    CHECK(report.residual > 1e4 * eps);
    CHECK(std::abs(momentum() - before) < 200 * eps * mass);
    double held = 0;
    for (Index node : left)
      held = std::max(held, std::abs(body.displacements()[static_cast<std::size_t>(node)][1]));
    CHECK(held == 0);
  });
}

TEST_CASE("steps follow the error that was asked for", "[solver]") {
  auto const run = [](auto const& scheme, double error) {
    auto body = stretched_square();
    auto const report =
        Implicit{scheme, {.step = 1e-2, .error = error, .tolerance = 1e-12}}.until(body, 0.3);
    CHECK(report.time == Approx(0.3).epsilon(1e-12));
    CHECK(report.error <= error);
    struct Result {
      VectorXd end;
      ImplicitReport report;
    };
    return Result{vector_of(body, body.displacements()), report};
  };
  VectorXd const exact = end_of_swing(Newmark{}, 2000);
  auto const check = [&](auto const& scheme) {
    CAPTURE(scheme.name);
    auto const rough = run(scheme, 1e-4), fine = run(scheme, 1e-6);
    CHECK(fine.report.steps > 3 * rough.report.steps);
    CHECK((fine.end - exact).norm() < 0.2 * (rough.end - exact).norm());
    // As many local errors as there are steps, or fewer.
    CHECK((fine.end - exact).norm() < 1e-6 * fine.report.steps);
  };
  check(Newmark{});
  check(GeneralizedAlpha{0.8});
  check(BDF2{});
}

TEST_CASE("reports tell how far displacements may be off", "[solver]") {
  VectorXd const exact = end_of_swing(Newmark{}, 2000);
  auto const check = [&](auto const& scheme, double step) {
    CAPTURE(scheme.name);
    auto body = stretched_square();
    auto const report = Implicit{scheme, {.step = step, .tolerance = 1e-12}}.until(body, 0.3);
    double const off =
        (vector_of(body, body.displacements()) - exact).template lpNorm<Eigen::Infinity>();
    CHECK(report.error_in_all > off);
    CHECK(report.error_in_all < 30 * off);
  };
  check(BackwardEuler{}, 1e-3);
  check(Newmark{}, 3e-3);
  check(GeneralizedAlpha{0.8}, 3e-3);
  check(BDF2{}, 2e-3);
}

TEST_CASE("reports tell what of the residual single precision leaves", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto body = beam<Rubber>(backend);
    auto const report = Implicit{Newmark{}, {.step = 1e-3}}(body, 3);
    if (sizeof(typename B::scalar) == 8) {
      CHECK(report.reached <= 1e-10);
    } else {
      CHECK(report.reached > 1e-10);
      CHECK(report.reached < 1e-4);
    }
  });
}

TEST_CASE("bodies in single precision reach the tolerance that was asked", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const method = GENERATE(LinearMethod::direct, LinearMethod::matrix_free);
    auto const kind = GENERATE(MassMatrix::consistent, MassMatrix::lumped);
    auto const run = [&](auto const& scheme, auto const& on) {
      Body body{on, mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}), Elastic{2e5, 0.3, 1000},
                Group<Rubber>{}};
      body.drive(body.mesh().boundary("left"), [](double t) {
        return Point<2>{0.01 * std::sin(40 * t), 0};
      });
      refine(body, {{3, 4}});
      body.set_gravity({0, -10});
      body.set_load(body.nodes() - 1, {0, 10});
      body.set_damping(2);
      auto const report = Implicit{scheme,
                                   {.step = 5e-3,
                                    .mass = kind,
                                    .stiffness_damping = 1e-3,
                                    .tolerance = 1e-9,
                                    .linear = method}}(body, 10);
      CHECK(report.reached <= 1e-9);
      CHECK((report.corrections > 0) ==
            (sizeof(typename std::remove_cvref_t<decltype(on)>::scalar) < 8));
      return body.displacements();
    };
    auto const check = [&](auto const& scheme) {
      CAPTURE(scheme.name);
      auto const u = run(scheme, backend), exact = run(scheme, Reference<double>{});
      CHECK(difference(u, exact) < 1e-5 * largest(exact));
    };
    check(BDF2{});
    check(GeneralizedAlpha{0.5});
  });
}

TEST_CASE("a first step that is too long is made shorter", "[solver]") {
  auto body = beam<Rubber>(MainBackend{});
  Implicit step{Newmark{}, {.step = 0.1, .error = 1e-5}};
  auto const report = step(body, 3);
  CHECK(report.rejected > 0);
  CHECK(report.steps == 3);
  CHECK(report.step < 0.02);
  CHECK(body.state().implicit.next_step > 0);
}

TEST_CASE("runs with steps by their error are saved and go on with the same bits",
          "[solver][state]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto whole = beam<Rubber>(backend), first = beam<Rubber>(backend),
         second = beam<Rubber>(backend);
    ImplicitOptions const options{.step = 1e-3, .error = 1e-4, .tolerance = 1e-6};
    Implicit step{BDF2{}, options}, other{BDF2{}, options}, anew{BDF2{}, options};
    step(whole, 4);
    other(first, 4);
    std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
    first.save(file);
    second.load(file);
    step(whole, 3);
    anew(second, 3);
    if (between_runs(1) == 0) CHECK(first_difference(whole.state(), second.state()) == "");
    CHECK(difference(whole.displacements(), second.displacements()) <= between_runs(1e-6));
    CHECK(whole.state().implicit.step != options.step);
  });
}

TEST_CASE("the motion of a viscous body is that of short explicit steps", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Group<Gel> const gel{
        KelvinVoigt<NeoHookean>::law<double>{NeoHookean<double>::from({1e5, 0.3, 1000}), 2e4}};
    auto by_bdf = beam<Gel>(backend, gel), by_newmark = beam<Gel>(backend, gel),
         reference = beam<Gel>(backend, gel);
    ImplicitOptions const options{.step = 2e-3, .mass = MassMatrix::lumped};
    Implicit{BDF2{}, options}(by_bdf, 50);
    Implicit{GeneralizedAlpha{}, options}(by_newmark, 50);
    CentralDifference{{.step = 1e-5}}(reference, 10000);
    auto const u = reference.displacements();
    CHECK(difference(by_bdf.displacements(), u) < 0.03 * largest(u));
    CHECK(difference(by_newmark.displacements(), u) < 0.03 * largest(u));
    CHECK(largest(u) > 0.02);
  });
}

TEST_CASE("backward Euler stands steps of hundreds of stable ones", "[solver]") {
  auto body = beam<Rubber>(MainBackend{});
  body.set_gravity({0, -5});
  double const stable = stable_step(body);
  Implicit step{BackwardEuler{}, {.step = 300 * stable}};
  double last = total_energy_of(body.parts());
  for (int k = 0; k < 40; ++k) {
    step(body);
    double const now = total_energy_of(body.parts());
    CHECK(now < last + 1e-6);
    last = now;
  }
  step(body, 100);
  CHECK(largest(body.velocities()) < 1e-3);
  CHECK(body.displacements()[8][1] < -0.05);

  // Under twice that weight full steps of Newton's method go astray, and searched ones do not.
  auto heavy = beam<Rubber>(MainBackend{});
  heavy.set_velocities(FieldOf<2>(static_cast<std::size_t>(heavy.nodes())));
  heavy.set_gravity({0, -10});
  Implicit searching{BackwardEuler{}, {.step = 100 * stable}};
  searching(heavy, 40);
  CHECK(largest(heavy.velocities()) < 1e-3);
  CHECK(heavy.displacements()[8][1] < -0.1);
}

TEST_CASE("an explicit run and an implicit one exchange states", "[solver][state]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto mixed = beam<Rubber>(backend), plain = beam<Rubber>(backend);
    double const h = 1e-4;
    for (int k = 0; k < 5; ++k) {
      CentralDifference{{.step = h}}(mixed, 100);
      Implicit{GeneralizedAlpha{}, {.step = h, .mass = MassMatrix::lumped}}(mixed, 100);
    }
    CentralDifference{{.step = h}}(plain, 1000);
    CHECK(mixed.time() == Approx(plain.time()));
    CHECK(difference(mixed.displacements(), plain.displacements()) <
          1e-3 * largest(plain.displacements()));
  });
}

TEST_CASE("options that no scheme can work with are refused", "[solver]") {
  double const nan{NAN};
  CHECK_THROWS_WITH((Implicit{BDF2{}, {.step = -1}}), says("BDF2: step"));
  CHECK_THROWS_WITH((Implicit{BackwardEuler{}, {.step = 1, .error = nan}}), says("an error of"));
  CHECK_THROWS_WITH((Implicit{BackwardEuler{}, {.step = 1, .stiffness_damping = -1}}),
                    says("stiffness damping"));
  CHECK_THROWS_WITH((Implicit{BackwardEuler{}, {.step = 1, .max_linear_iterations = 0}}),
                    says("max_linear_iterations 0"));
  for (double radius : {-0.1, 1.1, nan})
    CHECK_THROWS_WITH((Implicit{GeneralizedAlpha{radius}, {.step = 1}}), says("spectral radius"));
  auto body = beam<Linear>(MainBackend{});
  Implicit step{BDF2{}, {.step = 1e-2}};
  step(body, 2);
  CHECK_THROWS_WITH(step.until(body, 1e-2), says("not a later one"));
  CHECK_THROWS_WITH(step.until(body, nan), says("not a later one"));
  CHECK(step.until(body, body.time()).steps == 0);
  body.press(body.mesh().boundary("right"), 100);
  Implicit matrix_free{BDF2{}, {.step = 1e-2, .linear = LinearMethod::matrix_free}};
  CHECK_THROWS_WITH(matrix_free(body), says("follow a surface"));
  CHECK(step(body).linear.method == LinearMethod::direct);
}

}  // namespace pliant::test::schemes_suite
