#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::discrepancies_suite {

using Small = Formulation<Hex8, Gauss<2>, Hooke>;
using Large = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
static_assert(Estimator<LawDiscrepancy<Large>, Small>);
static_assert(Estimator<QuadratureDiscrepancy<Small>, Formulation<Hex8, OnePoint, Hooke>>);

/// λ = 3, μ = 2 Pa, E = 5.2 Pa (REFERENCES, section 6).
inline constexpr Hooke<double> printed_hooke{3, 2};
inline constexpr SaintVenantKirchhoff<double> printed_svk{3, 2};

TEST_CASE("the discrepancy of laws is that of their printed stresses", "[estimator]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Hex8>(2);
    // The material's modulus is another: those of the groups' laws count.
    Body body{backend, mesh, Elastic{77, 0.1, 1}, Group<Small>{printed_hooke},
              Group<Large>{printed_svk}};
    auto h = Tensor<double, 3>::zero();
    h(0, 0) = 0.2;
    body.set_displacements(uniform(mesh.nodes, h));
    double const off = square(1.848 - 1.4) + 2 * square(0.66 - 0.6);

    double const there = estimate(body, LawDiscrepancy<Large>{});
    std::vector<Index> all(mesh.elements<Hex8>().size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
    body.template assign<Large>(all);
    double const back = estimate(body, LawDiscrepancy<Small>{}),
                 with_itself = estimate(body, LawDiscrepancy<Large>{});

    CHECK(there == Approx(off / (2 * 5.2)).epsilon(1e-5));  // volume 1
    CHECK(back == Approx(there).epsilon(1e-5));
    CHECK(with_itself == 0);
  });
}

TEST_CASE("sheets, fibres and values per element have their moduli", "[estimator]") {
  auto const young = [](auto const& law) { return detail::young_at_rest(law); };
  CHECK(young(Hooke<double>{3, 2}) == Approx(5.2));
  CHECK(young(NeoHookean<double>{3, 2}) == Approx(5.2));
  CHECK(young(PlaneStress<Hooke>::law<double>{{{3, 2}}}) == Approx(5.2));
  CHECK(young(PlaneStress<NeoHookean>::law<double>{{{3, 2}}}) == Approx(5.2));
}

TEST_CASE("rules switch by the discrepancy of laws both ways", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Cheap = Formulation<Tri3, Gauss<1>, Hooke>;
    using Dear = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const mesh = distorted_mesh<Tri3>(6);
    Body body{backend, mesh, soft, Group<Cheap>{}, Group<Dear>{}};
    body.set_displacements(Random(4).field<2>(mesh.nodes.size(), 0.01));
    auto const value =
        evaluate<Tri3>(body, largest(LawDiscrepancy<Dear>{}, LawDiscrepancy<Cheap>{}));
    auto sorted = value;
    std::ranges::sort(sorted);
    double const limit = sorted[sorted.size() / 2];
    Adaptation switching{when<Cheap>(LawDiscrepancy<Dear>{}).above(limit).template become<Dear>(),
                         when<Dear>(LawDiscrepancy<Cheap>{}).below(limit).template become<Cheap>()};

    switching.now(body);
    auto const groups = body.template groups_of<Tri3>();
    switching.now(body);
    auto const again = body.template groups_of<Tri3>();
    body.set_displacements(FieldOf<2>(mesh.nodes.size()));
    switching.now(body);
    auto const at_rest = body.template groups_of<Tri3>();

    for (std::size_t e = 0; e < value.size(); ++e) CHECK(groups[e] == (value[e] > limit));
    CHECK(std::ranges::count(groups, 1) > 10);
    CHECK(again == groups);
    CHECK(std::ranges::count(at_rest, 1) == 0);
  });
}

/// The strain energy of one element under a formulation.
template <class F, class B, class M, class U>
double energy_under(B const& backend, M const& mesh, U const& u) {
  auto body = body_of<F>(backend, mesh);
  body.set_displacements(u);
  return strain_energy(body);
}

TEST_CASE("the discrepancy of rules in an hourglass is in closed form", "[estimator]") {
  // Both rules resist with forces along the hourglass: (k − k₁)²/(2 k) |u|² with energies k |u|²/2, k₁ |u|²/2.
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const check = [&]<Element E>(E) {
      using One = Formulation<E, OnePoint, Hooke>;
      using Full = Formulation<E, Gauss<2>, Hooke>;
      Mesh<E> mesh;
      if constexpr (E::dim == 2)
        mesh = mesh::rectangle<E>({.size = {1, 1}, .cells = {1, 1}});
      else
        mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {1, 1, 1}});
      auto u = mesh.nodes;
      for (auto& p : u) {
        double sign = 0.01;
        for (std::size_t k = 0; k < E::dim; ++k) sign *= p[k] > 0.5 ? 1 : -1;
        p = {};
        p[0] = sign;
      }
      auto body = body_of<One>(backend, mesh);
      body.set_displacements(u);
      double const one = energy_under<One>(Reference<double>{}, mesh, u),
                   full = energy_under<Full>(Reference<double>{}, mesh, u);

      double const found = estimate(body, QuadratureDiscrepancy<Full>{});

      CHECK(found == Approx(square(full - one) / full).epsilon(1e-4));
      CHECK(found > 0.01 * full);
    };
    check(Quad4{});
    check(Hex8{});
  });
}

TEST_CASE("uniform deformation is the same to all rules", "[estimator]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const check = [&]<class F, class To>(List<F, To>) {
      auto const mesh = distorted_mesh<typename F::element>(3);
      auto body = body_of<F>(backend, mesh);
      body.set_displacements(uniform(mesh.nodes, Random(4).tensor<F::dim>(0.1)));
      double const energy = strain_energy(body);

      double const of_uniform = estimate(body, QuadratureDiscrepancy<To>{});
      body.set_displacements(FieldOf<std::size_t{F::dim}>(mesh.nodes.size()));
      double const at_rest = estimate(body, QuadratureDiscrepancy<To>{});
      body.set_displacements(Random(4).field<F::dim>(mesh.nodes.size(), 0.02));

      CHECK(of_uniform < 1e-24 * energy);
      CHECK(at_rest == 0);
      CHECK(estimate(body, QuadratureDiscrepancy<To>{}) > 1e-3 * strain_energy(body));
    };
    check(
        List<Formulation<Quad4, OnePoint, NeoHookean>, Formulation<Quad4, Gauss<2>, NeoHookean>>{});
    check(List<Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>,
               Formulation<Quad4, Gauss<2>, NeoHookean>>{});
    check(List<Formulation<Hex8, OnePoint, Hooke>, Formulation<Hex8, FBar<Gauss<2>>, Hooke>>{});
  });
}

}  // namespace pliant::test::discrepancies_suite
