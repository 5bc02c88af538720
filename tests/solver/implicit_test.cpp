#include <pliant/solver/implicit.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/assembly.hpp"
#include "support/elements.hpp"
#include "support/seed_scene.hpp"

namespace pliant::test::implicit_test {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Linear = Formulation<Quad4, Gauss<2>, Hooke>;

template <class F>
auto swinging_beam() {
  auto body = seed_body<F>(Reference<double>{});
  body.set_gravity({0, 0});
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = {0, 3 * square(body.mesh().nodes[i][0])};
  body.set_velocities(v);
  return body;
}
Eigen::Map<Eigen::VectorXd const> as_vector(std::vector<double> const& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}
template <class TheBody>
double energy_of_motion(TheBody& body, Eigen::SparseMatrix<double> const& mass) {
  auto const list = flat<double>(body.velocities());
  auto const v = as_vector(list);
  return v.dot(mass * v) / 2;
}

TEMPLATE_TEST_CASE("consistent masses move as one with the whole mass", "[solver]", ALL_ELEMENTS) {
  constexpr int dim = TestType::dim;
  auto const mesh = distorted_mesh<TestType>(3);
  auto const body =
      body_of<Formulation<TestType, Gauss<3>, Hooke>>(Reference<double>{}, mesh, {1, 0.3, 2});
  auto const mass = assemble_mass(body);
  // In u = (x, y): ½ u·M u is the integral of ρ (x² + y²)/2, exact where sides are straight.
  Eigen::VectorXd ones(mass.rows()), place = Eigen::VectorXd::Zero(mass.rows());
  ones.setOnes();
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      place[static_cast<Eigen::Index>(dim * i + k)] = mesh.nodes[i][k];
  double const x_squared = (0.75 * 0.75 * 0.75 + 0.25 * 0.25 * 0.25) / 3;
  double const y_squared = (1.5 * 1.5 * 1.5 - 0.5 * 0.5 * 0.5) / 3;
  CHECK(ones.dot(mass * ones) == Approx(2 * dim).epsilon(1e-13));
  CHECK(place.dot(mass * place) == Approx(2 * (x_squared + y_squared)).epsilon(1e-12));
  CHECK((mass - Eigen::SparseMatrix<double>(mass.transpose())).norm() < 1e-15);
  auto const lumped = assemble_mass(body, MassMatrix::lumped);
  CHECK(ones.dot(lumped * ones) == Approx(2 * dim).epsilon(1e-13));
  CHECK(lumped.nonZeros() <= lumped.rows());
}

TEST_CASE("slaves hand their consistent masses to their masters", "[solver]") {
  auto body =
      plane_body(Reference<double>{}, mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {2, 2}}));
  refine(body, {{0}});
  auto const mass = assemble_mass(body);
  Eigen::VectorXd const ones = Eigen::VectorXd::Ones(mass.rows());
  CHECK(ones.dot(mass * ones) == Approx(2 * soft.density).epsilon(1e-14));
  REQUIRE(!body.state().topology->interpolation.slaves().empty());
  for (auto const& slave : body.state().topology->interpolation.slaves())
    CHECK(mass.col(2 * slave.node).norm() + mass.row(2 * slave.node).norm() == 0);
}

TEST_CASE("a beam swings as in two other codes", "[solver]") {
  // REFERENCES, section 12d: straight clamp, Quad9 20 x 2, consistent mass, trapezoidal rule.
  using F = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
  auto const mesh =
      mesh::rectangle<Quad9>({.size = {0.35, 0.02}, .cells = {20, 2}, .origin = {0, -0.01}});
  Body body{Reference<double>{}, mesh, Elastic{1.4e6, 0.4, 1000}, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -2});
  Implicit step{Newmark{}, {.step = 2e-3}};

  step(body, 50);

  auto const tip = body.displacements()[20 + 21];
  CHECK(body.mesh().nodes[20 + 21][0] == Approx(0.35));
  CHECK(std::abs(body.mesh().nodes[20 + 21][1]) < 1e-15);
  CHECK(std::abs(tip[0] - -2.7559663272e-04) < 1e-11);
  CHECK(std::abs(tip[1] - -1.3585222538e-02) < 1e-10);
  CHECK(body.time() == Approx(0.1));
}

TEST_CASE("single steps are the same as many, on a body that only it moves", "[solver]") {
  auto at_once = swinging_beam<Rubber>(), one_by_one = swinging_beam<Rubber>();
  for (auto* body : {&at_once, &one_by_one}) {
    body->release(body->state().prescribed->conditions[0].handle);
    body->drive(body->mesh().boundary("left"), [](double t) {
      return Point<2>{0, 0.1 * std::sin(20 * t)};
    });
  }
  Implicit first{Newmark{}, {.step = 1e-3}}, second{Newmark{}, {.step = 1e-3}};
  first(at_once, 10);
  for (int k = 0; k < 10; ++k) second(one_by_one);
  CHECK(difference(at_once.displacements(), one_by_one.displacements()) == 0);
  CHECK(difference(at_once.velocities(), one_by_one.velocities()) == 0);
  CHECK(at_once.displacements()[0][1] == Approx(0.1 * std::sin(0.2)).epsilon(1e-14));
  CHECK(largest(at_once.displacements()) > 0.02);
}

TEST_CASE("the trapezoidal rule keeps the energy of a linear body", "[solver]") {
  auto const kind = GENERATE(MassMatrix::consistent, MassMatrix::lumped);
  auto body = swinging_beam<Linear>();
  auto const mass = assemble_mass(body, kind);
  double const before = energy_of_motion(body, mass);
  Implicit step{Newmark{}, {.step = 5e-3, .mass = kind}};
  for (int k = 0; k < 20; ++k) {
    step(body, 5);
    CHECK(energy_of_motion(body, mass) + strain_energy(body) == Approx(before).epsilon(1e-9));
  }
  CHECK(largest(body.displacements()) > 0.05);
}

TEST_CASE("gamma above one half takes energy", "[solver]") {
  auto body = swinging_beam<Linear>();
  auto const mass = assemble_mass(body);
  double const before = energy_of_motion(body, mass);
  Implicit step{Newmark{0.36, 0.7}, {.step = 5e-3}};
  step(body, 100);
  double const after = energy_of_motion(body, mass) + strain_energy(body);
  CHECK(after < 0.99 * before);
  CHECK(after > 0.01 * before);
}

TEST_CASE("the error of the trapezoidal rule falls as the square of its step", "[solver]") {
  auto const end = [](int steps) {
    auto body = body_of<Rubber>(Reference<double>{}, regular_mesh<Quad4>(3));
    body.set_displacements(uniform(body.mesh().nodes, Tensor<double, 2>{{{0.3, 0.1}, {0, -0.1}}}));
    Implicit{Newmark{}, {.step = 0.3 / steps}}(body, steps);
    return body.displacements()[0][0];
  };
  double const coarse = end(320), middle = end(640), fine = end(1280);
  CHECK((coarse - middle) / (middle - fine) == Approx(4).epsilon(0.05));
}

TEST_CASE("a free body keeps its momentum and falls as a stone", "[solver]") {
  auto const kind = GENERATE(MassMatrix::consistent, MassMatrix::lumped);
  auto body = body_of<Rubber>(Reference<double>{}, distorted_mesh<Quad4>(4));
  auto v = Random(1).field<2>(static_cast<std::size_t>(body.nodes()), 0.3);
  body.set_velocities(v);
  body.set_gravity({0, -10});
  auto const mass = assemble_mass(body, kind);
  auto const momentum = [&] {
    auto const list = flat<double>(body.velocities());
    Eigen::VectorXd const p = mass * as_vector(list);
    Point<2> sum{};
    for (Eigen::Index i = 0; i < p.size(); ++i) sum[static_cast<std::size_t>(i % 2)] += p[i];
    return sum;
  };
  auto const before = momentum();
  Implicit step{Newmark{}, {.step = 1e-2, .mass = kind}};
  step(body, 10);
  auto const after = momentum();
  CHECK(after[0] == Approx(before[0]).margin(1e-9));
  CHECK(after[1] == Approx(before[1] - 10 * 0.1 * soft.density).epsilon(1e-9));
}

TEST_CASE("damping slows a free body by its share in each step", "[solver]") {
  auto body = body_of<Rubber>(Reference<double>{}, distorted_mesh<Quad4>(3));
  body.set_velocities(std::vector<Point<2>>(static_cast<std::size_t>(body.nodes()), {1, 2}));
  body.set_damping(3);
  Implicit step{Newmark{}, {.step = 0.1}};
  step(body, 5);
  double const factor = std::pow((1 - 0.15) / (1 + 0.15), 5);
  for (auto const& v : body.velocities()) {
    CHECK(v[0] == Approx(factor).epsilon(1e-9));
    CHECK(v[1] == Approx(2 * factor).epsilon(1e-9));
  }
}

TEMPLATE_TEST_CASE("a step that does not converge leaves the body at the last one that did",
                   "[solver]", float, double) {
  // 0.1 s and its sums are rounded.
  using T = TestType;
  auto const steps_until_failure = [](int steps) {
    auto body = seed_body<Rubber>(Reference<T>{});
    auto v = body.velocities();
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = {0, 3 * square(body.mesh().nodes[i][0])};
    body.set_velocities(v);
    Implicit{Newmark{}, {.step = 0.1e-2}}(body, steps);
    return body;
  };
  auto body = steps_until_failure(3);
  auto const u = body.displacements(), v = body.velocities();
  double const time = body.time();
  Implicit hasty{Newmark{}, {.step = 10, .max_iterations = 1}};
  CHECK_THROWS_WITH(hasty(body), says("Newmark: no convergence"));
  CHECK(difference(body.displacements(), u) == 0);
  CHECK(difference(body.velocities(), v) == 0);
  CHECK(body.time() == time);
  CHECK(body.steps() == 3);
}

TEST_CASE("steps before one that fails are kept as they were taken", "[solver]") {
  auto const driven = [](double end) {
    auto body = swinging_beam<Rubber>();
    body.drive(std::vector<Index>{20}, [end](double t) {
      return Point<2>{t > end ? double{NAN} : 0.0, 0.1 * t};
    });
    return body;
  };
  auto body = driven(7.5e-3), whole = driven(1);
  Implicit step{Newmark{}, {.step = 1e-3}}, other{Newmark{}, {.step = 1e-3}};
  CHECK_THROWS_WITH(step(body, 20), says("body.drive: the motion of node 20"));
  other(whole, 7);
  CHECK(difference(body.displacements(), whole.displacements()) == 0);
  CHECK(difference(body.velocities(), whole.velocities()) == 0);
  CHECK(body.time() == whole.time());
  CHECK(body.steps() == 7);
}

TEST_CASE("a load that is set between steps pulls at once", "[solver]") {
  auto const moved = [](bool in_one) {
    auto body = body_of<Linear>(Reference<double>{}, regular_mesh<Quad4>(3));
    body.set_load(1, {0, 0.1});
    Implicit first{Newmark{}, {.step = 1e-2}}, second{Newmark{}, {.step = 1e-2}};
    first(body, 2);
    body.set_load(0, {1, 0});
    (in_one ? first : second)(body, 2);
    return body.displacements();
  };
  auto const u = moved(true);
  CHECK(difference(u, moved(false)) < 1e-12 * largest(u));
  CHECK(largest(u) > 1e-5);
}

TEST_CASE("options of Newmark that cannot work are refused", "[solver]") {
  double const inf = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH((Implicit{Newmark{}, {}}), says("Newmark: step"));
  for (double step : {-1e-3, inf, double{NAN}})
    CHECK_THROWS_WITH((Implicit{Newmark{}, {.step = step}}), says("Newmark: step"));
  for (double beta : {0.0, -0.25, 1.5, inf, double{NAN}})
    CHECK_THROWS_WITH((Implicit{Newmark{.beta = beta}, {.step = 1e-3}}), says("Newmark: beta"));
  for (double gamma : {0.4, 1.5, double{NAN}})
    CHECK_THROWS_WITH((Implicit{Newmark{.gamma = gamma}, {.step = 1e-3}}), says("Newmark: beta"));
  for (double tolerance : {0.0, -1.0, 1.0, double{NAN}})
    CHECK_THROWS_WITH((Implicit{Newmark{}, {.step = 1e-3, .tolerance = tolerance}}),
                      says("a tolerance of"));
  CHECK_THROWS_WITH((Implicit{Newmark{}, {.step = 1e-3, .max_iterations = 0}}),
                    says("max_iterations 0"));
}

inline auto block(double young = 1e5, int cells = 8) {
  return body_of<Linear>(Reference<double>{},
                         mesh::rectangle({.size = {1, 0.25}, .cells = {cells, 2}}),
                         {young, 0.3, 1e3});
}

TEST_CASE("a body that is drawn along at its speed stays unstrained, whatever is set", "[solver]") {
  for (int mode : {0, 1, 2, 3}) {
    CAPTURE(mode);
    auto body = block();
    auto const nodes = static_cast<std::size_t>(body.nodes());
    body.drive(body.mesh().boundary("left"), [](double t) { return Point<2>{0.1 * t, 0}; });
    body.set_velocities(FieldOf<2>(nodes, {0.1, 0}));
    Implicit step{Newmark{}, {.step = 1e-3}};
    for (int k = 0; k < 50; ++k) {
      if (mode == 1) body.set_loads(FieldOf<2>(nodes));
      if (mode == 2) body.set_gravity({0, 0});
      if (mode == 3)
        Implicit{Newmark{}, {.step = 1e-3}}(body);
      else
        step(body);
    }
    CHECK(body.displacements()[0][0] == Approx(0.1 * body.time()));
    CHECK(body.velocities()[8][0] == Approx(0.1).epsilon(1e-9));
    CHECK(strain_energy(body) < 1e-20);
  }
}

TEST_CASE("a motion that begins at time zero is not asked for before", "[solver]") {
  auto body = block();
  body.drive(body.mesh().boundary("left"), [](double t) { return Point<2>{std::sqrt(t), 0}; });
  Implicit step{Newmark{}, {.step = 1e-3}};
  CHECK_NOTHROW(step(body, 3));
}

TEST_CASE("one integrator takes any body for what it is", "[solver]") {
  Implicit shared{Newmark{}, {.step = 1e-2}};
  FieldOf<2> u, v;
  for (double young : {1e5, 1e7}) {  // the second one where the first was in memory, as a rule
    auto body = block(young), twin = block(young);
    for (auto* each : {&body, &twin}) {
      each->clamp(each->mesh().boundary("left"));
      each->set_gravity({0, -1});
      if (u.empty()) continue;
      each->set_displacements(u);
      each->set_velocities(v);
    }
    Implicit own{Newmark{}, {.step = 1e-2}};
    shared(body, 3);
    own(twin, 3);
    CHECK(difference(body.displacements(), twin.displacements()) == 0);
    u = body.displacements();
    v = body.velocities();
  }
  for (int cells : {4, 8, 16}) {
    auto body = block(1e5, cells);
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -1});
    CHECK_NOTHROW(shared(body, 2));
  }
}

TEST_CASE("Newmark and central differences take turns", "[solver]") {
  auto body = block(), twin = block();
  CentralDifference explicitly{{.step = 1e-3}}, anew{{.step = 1e-3}};
  for (auto* each : {&body, &twin}) {
    each->clamp(each->mesh().boundary("left"));
    each->set_gravity({0, -1});
    Implicit{Newmark{}, {.step = 1e-2}}(*each, 3);
  }
  explicitly(body);
  anew(twin);
  Implicit{Newmark{}, {.step = 1e-2}}(body);
  Implicit{Newmark{}, {.step = 1e-2}}(twin);
  explicitly(body, 300);
  CentralDifference{{.step = 1e-3}}(twin, 300);
  CHECK(difference(body.displacements(), twin.displacements()) == 0);
  CHECK(explicitly.retries() == 0);
}

TEST_CASE("no step changes nothing, and fewer are refused", "[solver]") {
  auto body = block();
  body.clamp(body.mesh().boundary("left"));
  body.set_velocities(FieldOf<2>(static_cast<std::size_t>(body.nodes()), {0.1, 0}));
  auto const v = body.velocities();
  Implicit step{Newmark{}, {.step = 1e-2}};
  step(body, 0);
  CHECK(body.steps() == 0);
  CHECK(body.velocities() == v);
  CHECK(body.parts().integrator == nullptr);
  CHECK_THROWS_WITH(step(body, -5), says("-5 steps"));
}

}  // namespace pliant::test::implicit_test
