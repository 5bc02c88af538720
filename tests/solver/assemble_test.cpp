#include <limits>

#include <pliant/solve.hpp>

#include "support/assembly.hpp"
#include "support/formulations.hpp"

// What is assembled agrees with what a body computes without matrices.
namespace pliant::test::assemble_test {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <std::size_t Dim>
Eigen::VectorXd as_vector(FieldOf<Dim> const& field) {
  auto const values = flat<double>(field);
  return Eigen::Map<Eigen::VectorXd const>(values.data(), static_cast<Eigen::Index>(values.size()));
}

template <class F>
void check_with_internal_variables(typename F::template law<double> const& law) {
  INFO(formulation_name<F>());
  constexpr int dim = F::dim;
  auto const mesh = distorted_mesh<typename F::element>(3);
  Body body{Reference<double>{}, mesh, soft, Group<F>{law}};
  auto const n = mesh.nodes.size();
  auto const earlier = flat<double>(Random(1).field<dim>(n, 0.03));
  auto const u = Random(2).field<dim>(n, 0.03), du = Random(3).field<dim>(n, 1.0);
  auto const at = flat<double>(u), along = flat<double>(du);
  body.commit(earlier.data(), 0.02);

  for (double dt : {1e-3, 0.05, 2.0}) {
    std::vector<double> f(at.size()), df(at.size());
    body.add_force(at.data(), f.data(), dim, dt);
    body.add_tangent_product(at.data(), along.data(), df.data(), 1, dim, dt);
    auto const assembled = assemble(body, as_vector(u), dt);
    Eigen::VectorXd const product = -(assembled.stiffness * as_vector(du));
    CHECK(difference(per_node<dim>(df),
                     per_node<dim>(std::vector<double>(product.begin(), product.end()))) <
          1e-12 * product.norm());
    CHECK(difference(per_node<dim>(f), per_node<dim>(std::vector<double>(assembled.force.begin(),
                                                                         assembled.force.end()))) <
          1e-12 * assembled.force.norm());
  }
  auto const quick = assemble(body, as_vector(u), 1e-3), slow = assemble(body, as_vector(u), 1e9);
  CHECK((quick.stiffness - slow.stiffness).norm() > 0.1 * slow.stiffness.norm());
  CHECK_THROWS_WITH(assemble(body, as_vector(u), -1.0), says("assemble: a time of -1"));
  CHECK_THROWS_WITH(assemble(body, as_vector(u), double{NAN}), says("assemble: a time of"));
}

TEST_CASE("the assembled matrix sees internal variables and the time since they were committed",
          "[solver]") {
  check_with_internal_variables<
      Formulation<Quad4, Gauss<2>, KelvinVoigt<NeoHookean>::template law>>({{3, 2}, 0.5});
  check_with_internal_variables<Formulation<Tet4, Gauss<1>, Prony<NeoHookean>::template law>>(
      {{3, 2}, {0.7}, {0.4}});
}

/// A spring between two nodes that rests at no length, with a dead part of its force at the first.
template <class T>
struct Spring {
  static constexpr int nodes = 2, dim = 2;
  T stiffness;
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 2, 2> const& rest, Matrix<S, 2, 2> const& u) const {
    S sum = S(0);
    for (int k = 0; k < 2; ++k) {
      S const apart = rest(1, k) + u(1, k) - rest(0, k) - u(0, k);
      sum = sum + apart * apart;
    }
    return stiffness / 2 * sum * sum + rest(0, 0) * u(0, 0);
  }
};

TEST_CASE("force terms of the user's own and pressures are assembled", "[solver]") {
  auto const mesh = distorted_mesh<Quad4>(4);
  auto body = body_of<Rubber>(Reference<double>{}, mesh);
  body.add(std::vector<std::array<Index, 2>>{{0, 5}, {3, 7}}, Spring<double>{4});
  body.press(mesh.boundary("right"), 0.7);
  auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
  body.set_displacements(u);

  auto const assembled = assemble(body, as_vector(u));

  Eigen::MatrixXd const k = assembled_stiffness(body, u);
  CHECK((Eigen::MatrixXd(assembled.stiffness) - k).norm() < 1e-13 * k.norm());
  CHECK((assembled.force - as_vector(body.forces())).norm() < 1e-13);
  CHECK(assembled.energy == Approx(strain_energy(body)).epsilon(1e-13));
}

TEST_CASE("a body rests where its elements and the user's terms balance", "[solver]") {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  for (int load_steps : {1, 3}) {
    auto body = body_of<Rubber>(Reference<double>{}, mesh);
    body.clamp(mesh.boundary("left"));
    body.add(std::vector<std::array<Index, 2>>{{8, 26}}, Spring<double>{4});
    solve_static(body, {.load_steps = load_steps});
    auto f = body.forces();
    for (Index i : nodes_of(mesh.boundary("left"))) f[static_cast<std::size_t>(i)] = {};
    CHECK(largest(f) < 1e-11);
    CHECK(largest(body.displacements()) > 1e-3);
  }
}

TEST_CASE("reactions are the residual that is assembled", "[solver]") {
  auto const mesh = distorted_mesh<Quad4>(4);
  auto body = body_of<Rubber>(Reference<double>{}, mesh);
  auto const left = body.hold(mesh.boundary("left"), 1);
  auto const right = body.drive(mesh.boundary("right"), [](double) { return Point<2>{0.1, 0.05}; });
  body.press(mesh.boundary("top"), 0.3);
  body.set_gravity({0.1, -0.2});
  body.set_load(3, {0.2, 0.1});
  body.set_load(nodes_of(mesh.boundary("left"))[1], {0.2, 0.1});
  auto u = Random(1).field<2>(mesh.nodes.size(), 0.02);
  for (bool solved : {false, true}) {
    if (solved)
      solve_static(body);
    else
      body.set_displacements(u);
    auto const force = assemble(body, as_vector(body.displacements())).force;
    auto const loads = nodal_loads(body);
    for (auto const& condition : body.state().prescribed->conditions) {
      auto const own = body.reactions(condition.handle);
      for (std::size_t n = 0; n < own.size(); ++n) {
        auto const i = static_cast<std::size_t>(condition.nodes[n]);
        for (std::size_t k = 0; k < 2; ++k) {
          double const pull = force[static_cast<Eigen::Index>(2 * i + k)] +
                              body.parts().layout.mass_list()[i] * body.state().gravity[k] +
                              loads[i][k];
          CHECK(own[n][k] == Approx(condition.directions >> k & 1 ? -pull : 0).margin(1e-12));
        }
      }
    }
    CHECK(difference(body.reactions(right), static_reactions(body, right)) < 1e-12);
    CHECK(largest(body.reactions(left)) > 0.01);
  }
}

}  // namespace pliant::test::assemble_test
