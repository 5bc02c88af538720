#pragma once

#include "support/difference_quotient.hpp"
#include "support/flat.hpp"
#include "support/formulations.hpp"

namespace pliant::test::force_terms_suite {

/// A spring between two nodes whose length at rest is their distance.
template <class T>
struct Spring {
  static constexpr int nodes = 2, dim = 2;
  T stiffness;  // N/m

  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 2, 2> const& rest, Matrix<S, 2, 2> const& u) const {
    auto const length = [](auto const& x) PLIANT_INLINE {
      return sqrt(square(x(1, 0) - x(0, 0)) + square(x(1, 1) - x(0, 1)));
    };
    return stiffness / 2 * square(length(rest + u) - length(rest));
  }
};

/// A force that has no energy: it turns around the place at rest.
template <class T>
struct Swirl {
  static constexpr int nodes = 1, dim = 2;
  T stiffness;  // N/m

  template <class S>
  PLIANT_HOST_DEVICE Matrix<S, 1, 2> force(Matrix<S, 1, 2> const&, Matrix<S, 1, 2> const& u) const {
    Matrix<S, 1, 2> f;
    f(0, 0) = -stiffness * u(0, 1);
    f(0, 1) = stiffness * u(0, 0) * u(0, 0);
    return f;
  }
};

/// A spring from a place in space to a node.
template <class T>
struct Anchor {
  static constexpr int nodes = 1, dim = 2;
  T stiffness, x, y;  // N/m, m, m

  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 1, 2> const& rest, Matrix<S, 1, 2> const& u) const {
    return stiffness / 2 * (square(rest(0, 0) + u(0, 0) - x) + square(rest(0, 1) + u(0, 1) - y));
  }
};

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Stiffer = Formulation<Quad4, Gauss<3>, SaintVenantKirchhoff>;
using Sets = std::vector<std::array<Index, 2>>;

static_assert(NodalPhysics<Spring<double>> && NodalPhysics<Swirl<double>>);
static_assert(detail::HasEnergy<Spring<double>, double> &&
              !detail::HasEnergy<Swirl<double>, double>);

/// A body under two laws, springs, a swirl and a pressure.
template <Backend B>
auto body_of_all_terms(B const& backend) {
  auto const mesh = distorted_mesh<Quad4>(4);
  Body body{backend, mesh, soft, Group<Rubber>{}, Group<Stiffer>{}};
  body.template assign<Stiffer>({1, 4, 5});
  using TheBody = decltype(body);
  static_assert(ForceTerm<ElementGroups<typename TheBody::layout_type>, B, 2>);
  static_assert(ForceTerm<AnyForceTerm<B, 2>, B, 2>);
  static_assert(ForceTerm<ConnectedTerm<B, Spring>, B, 2>);
  body.add(Sets{{0, 9}, {3, 9}, {2, 14}}, Spring<double>{7});
  body.add(std::vector<std::array<Index, 1>>{{4}, {9}}, Swirl<double>{3});
  body.press(mesh.boundary("right"), 0.5);
  return body;
}

/// One force term, asked with fields in the user's order.
template <class TheBody, class Term>
struct Asked {
  using T = typename TheBody::scalar;
  using Field = FieldOf<2>;
  TheBody& body;
  Term const& term;

  auto field(Field const& u) const { return upload(body.backend(), body.parts().layout.padded(u)); }
  template <class Ask>
  Field summed(Ask const& ask) const {
    auto const& parts = body.parts();
    auto out = zeros<T>(body.backend(), parts.layout.rest.size() +
                                            static_cast<std::size_t>(node_stride) *
                                                static_cast<std::size_t>(term.scratch_nodes()));
    ask(node_field<2>(out));
    auto all = download<T>(out);
    all.resize(parts.layout.rest.size());
    return parts.layout.in_user_order(upload(body.backend(), all));
  }
  /// ask(Placement) at displacements u.
  template <class Ask>
  auto at(Field const& u, Ask const& ask) const {
    auto const array = field(u);
    return ask(std::as_const(body).parts().at(node_field<2>(array)));
  }

  double energy(Field const& u) const {
    return at(u, [&](auto const& where) { return term.energy(body.backend(), where); });
  }
  Field force(Field const& u) const {
    return at(u, [&](auto const& where) {
      return summed([&](auto f) { term.add_force(body.backend(), where, f); });
    });
  }
  Field product(Field const& u, Field const& du, double factor = 1) const {
    auto const along = field(du);
    return at(u, [&](auto const& where) {
      return summed([&](auto f) {
        term.add_tangent_product(body.backend(), static_cast<T>(factor), where,
                                 node_field<2>(along), f);
      });
    });
  }
  Field diagonal(Field const& u, int column) const {
    return at(u, [&](auto const& where) {
      return summed([&](auto f) { term.add_diagonal(body.backend(), where, column, f); });
    });
  }
  Field row_sums(Field const& u) const {
    return at(u, [&](auto const& where) {
      return summed([&](auto f) { term.add_row_sums(body.backend(), where, f); });
    });
  }
};

/// Calls visit(Asked) for the elements, the pressure and the user's terms.
template <class TheBody, class Visit>
void on_each_term(TheBody& body, Visit const& visit) {
  for_each_force_term(std::as_const(body).parts(), [&](auto const& term) {
    visit(Asked<TheBody, std::remove_cvref_t<decltype(term)>>{body, term});
  });
}

TEST_CASE("a term's force is minus the derivative of its energy", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of_all_terms(backend);
    auto const n = static_cast<std::size_t>(body.nodes());
    auto const u = Random(1).field<2>(n, 0.02), along = Random(2).field<2>(n, 1);
    int with_energy = 0, without = 0;
    on_each_term(body, [&](auto const& asked) {
      auto const f = asked.force(u);
      REQUIRE(largest(f) > 1e-3);
      if (!asked.term.has_energy()) {
        CHECK(asked.energy(u) == 0);
        ++without;
        return;
      }
      ++with_energy;
      double const slope =
          derivative([&](double h) { return asked.energy(plus(u, h, along)); }, 1e-4);
      CHECK(slope == Approx(-inner(f, along)).epsilon(1e-7));
    });
    CHECK(with_energy == 2);
    CHECK(without == 2);
  });
}

TEST_CASE("a term's tangent product is the derivative of its force, and adds", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of_all_terms(backend);
    auto const n = static_cast<std::size_t>(body.nodes());
    auto const u = Random(1).field<2>(n, 0.02), along = Random(2).field<2>(n, 1);
    on_each_term(body, [&](auto const& asked) {
      auto const df = asked.product(u, along);
      auto const quotient =
          field_derivative<2>([&](double h) { return asked.force(plus(u, h, along)); }, 1e-4);
      CHECK(difference(df, quotient) < 1e-7 * largest(df));
      CHECK(difference(asked.product(u, along, -0.5), plus(FieldOf<2>(n), -0.5, df)) <
            1e-13 * largest(df));
    });
  });
}

TEST_CASE("a term's diagonal blocks and row sums are those of its matrix", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of_all_terms(backend);
    auto const n = static_cast<std::size_t>(body.nodes());
    auto const u = Random(1).field<2>(n, 0.02);
    on_each_term(body, [&](auto const& asked) {
      FieldOf<2> own[2] = {FieldOf<2>(n), FieldOf<2>(n)}, rows(n);
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < 2; ++k) {
          FieldOf<2> one(n);
          one[j][k] = 1;
          auto const column = asked.product(u, one);  // −K e_jk
          for (std::size_t i = 0; i < 2; ++i) own[k][j][i] = -column[j][i];
          for (std::size_t r = 0; r < n; ++r)
            for (std::size_t i = 0; i < 2; ++i) rows[r][i] += std::abs(column[r][i]);
        }
      for (int k = 0; k < 2; ++k)
        CHECK(difference(asked.diagonal(u, k), own[k]) < 1e-12 * (largest(own[k]) + 1e-3));
      // Elements are summed by their absolute values: at least those of the sum.
      auto const bound = asked.row_sums(u);
      bool const single = bound.size() == n;
      REQUIRE(single);
      double ratio = 0;
      for (std::size_t r = 0; r < n; ++r)
        for (std::size_t i = 0; i < 2; ++i) {
          CHECK(bound[r][i] >= rows[r][i] * (1 - 1e-12));
          ratio = std::max(ratio, bound[r][i] / std::max(rows[r][i], 1e-3));
        }
      CHECK(ratio < 4);
    });
  });
}

TEST_CASE("the elements of a term on the host add up to what its backend says", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of_all_terms(backend);
    auto const n = static_cast<std::size_t>(body.nodes());
    auto const u = Random(1).field<2>(n, 0.02);
    auto const& parts = body.parts();
    auto const check = [&](AnyForceTerm<B, 2> const& term) {
      Asked<decltype(body), AnyForceTerm<B, 2>> const asked{body, term};
      auto const user = [&](Index internal) {
        return static_cast<std::size_t>(parts.layout.user_of(internal));
      };
      double energy = 0;
      FieldOf<2> force(n), rows(n), diagonal[2] = {force, force};
      term.for_each_element([&](Index i) { return body.mesh().nodes[user(i)]; },
                            [&](Index i) { return u[user(i)]; }, true,
                            [&](ElementMatrix const& e) {
                              energy += e.energy;
                              std::size_t const size = 2 * e.nodes.size();
                              REQUIRE(e.force.size() == size);
                              REQUIRE(e.stiffness.size() == size * size);
                              for (std::size_t r = 0; r < size; ++r) {
                                force[user(e.nodes[r / 2])][r % 2] += e.force[r];
                                for (std::size_t c = 0; c < size; ++c) {
                                  double const k = e.stiffness[r * size + c];
                                  rows[user(e.nodes[r / 2])][r % 2] += std::abs(k);
                                  if (r / 2 == c / 2)
                                    diagonal[c % 2][user(e.nodes[r / 2])][r % 2] += k;
                                }
                              }
                            });
      CHECK(energy == Approx(asked.energy(u)).epsilon(1e-12));
      CHECK(difference(force, asked.force(u)) < 1e-13 * largest(force));
      CHECK(difference(rows, asked.row_sums(u)) < 1e-12 * largest(rows));
      for (int k = 0; k < 2; ++k)
        CHECK(difference(diagonal[k], asked.diagonal(u, k)) < 1e-12 * largest(rows));
      term.for_each_element([&](Index i) { return body.mesh().nodes[user(i)]; },
                            [&](Index i) { return u[user(i)]; }, false,
                            [](ElementMatrix const& e) { CHECK(e.stiffness.empty()); });
    };
    for (auto const& term : parts.terms) check(*term);
    for (auto const& term : parts.pressures) check(*term);
  });
}

TEST_CASE("a term of a body is part of its forces, energy and tangent", "[force]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    auto plain = body_of<Rubber>(backend, mesh), sprung = body_of<Rubber>(backend, mesh);
    Index const a = mesh.elements<Quad4>()[0][0], b = mesh.elements<Quad4>()[0][2];
    sprung.add(Sets{{a, b}}, Spring<double>{8});
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);

    auto const pulled = plus(forces_at(sprung, u), -1, forces_at(plain, u));

    auto const apart = [&](auto const& field) {
      return Point<2>{
          field[static_cast<std::size_t>(b)][0] - field[static_cast<std::size_t>(a)][0],
          field[static_cast<std::size_t>(b)][1] - field[static_cast<std::size_t>(a)][1]};
    };
    Point<2> const rest = apart(mesh.nodes), now = apart(plus(mesh.nodes, 1, u));
    double const length = std::hypot(now[0], now[1]),
                 longer = length - std::hypot(rest[0], rest[1]);
    double const rounding = 256 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    for (std::size_t k = 0; k < 2; ++k)
      CHECK(pulled[static_cast<std::size_t>(a)][k] ==
            Approx(8 * longer * now[k] / length).margin(rounding));
    CHECK(strain_energy(sprung) - strain_energy(plain) ==
          Approx(4 * longer * longer).margin(rounding));
  });
}

TEST_CASE("a physics sees nodes where the mesh has them", "[force]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh =
        shuffled(mesh::rectangle({.size = {1, 1}, .cells = {3, 3}, .origin = {4, -2}}));
    auto body = body_of<Rubber>(backend, mesh);
    std::vector<std::array<Index, 1>> all;
    for (Index i = 0; i < body.nodes(); ++i) all.push_back({i});
    body.add(all, Anchor<double>{2, 0.5, -0.25});
    for (bool refined : {false, true}) {
      if (refined) refine(body, {{0, 4}});
      FieldOf<2> const u(static_cast<std::size_t>(body.nodes()), {0.25, 0.125});  // no strain
      auto const f = forces_at(body, u);
      double const rounding = 256 * double{std::numeric_limits<typename B::scalar>::epsilon()};
      double energy = 0;
      for (auto const& [i] : all) {
        auto const n = static_cast<std::size_t>(i);
        Point<2> const apart{body.mesh().nodes[n][0] + 0.25 - 0.5, body.mesh().nodes[n][1] + 0.375};
        for (std::size_t k = 0; k < 2; ++k) {
          CHECK(f[n][k] == Approx(-2 * apart[k]).margin(rounding));
          energy += apart[k] * apart[k];
        }
      }
      CHECK(strain_energy(body) == Approx(energy).epsilon(rounding));
    }
    // The same of its elements on the host, whose places are relative to the body's middle too.
    auto const& layout = body.parts().layout;
    double energy = 0;
    body.parts().terms.at(0)->for_each_element(
        [&](Index i) {
          auto x = body.mesh().nodes[static_cast<std::size_t>(layout.user_of(i))];
          for (std::size_t k = 0; k < 2; ++k) x[k] -= layout.middle[k];
          return x;
        },
        [](Index) {
          return Point<2>{0.25, 0.125};
        },
        false, [&](ElementMatrix const& e) { energy += e.energy; });
    CHECK(energy == Approx(strain_energy(body)).epsilon(1e-4));
  });
}

TEST_CASE("a term stays with its nodes when the mesh is refined", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, mesh::rectangle({.size = {1, 1}, .cells = {3, 3}}));
    body.add(Sets{{0, 15}}, Spring<double>{8});
    refine(body, {{0, 4}});
    Index const hanging = body.mesh().slaves[0].node;
    body.add(Sets{{3, hanging}}, Spring<double>{0.5});
    refine(body, {{7}});

    auto const n = static_cast<std::size_t>(body.nodes());
    auto u = FieldOf<2>(n);
    for (std::size_t i = 0; i < n; ++i) u[i] = {0.125 * body.mesh().nodes[i][0], 0};
    auto const f = forces_at(body, u);
    auto const along = Random(3).field<2>(n, 1);
    double const slope = derivative(
        [&](double h) {
          body.set_displacements(plus(u, h, along));
          return strain_energy(body);
        },
        1e-4);
    CHECK(slope == Approx(-inner(f, along)).epsilon(1e-6));
    for (auto const& slave : body.mesh().slaves)
      CHECK(f[static_cast<std::size_t>(slave.node)] == Point<2>{});
  });
}

TEST_CASE("the stable step knows springs that are stiffer than the body", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    double const before = stable_step(body);
    Sets sets;
    for (Index i = 0; i + 10 < body.nodes(); ++i) sets.push_back({i, i + 10});
    body.add(sets, Spring<double>{5000});

    double const after = stable_step(body);

    CHECK(after < before / 8);
    CHECK(after > before / 200);
    body.set_velocities(Random(5).field<2>(mesh.nodes.size(), 0.01));
    double const energy = total_energy(body);
    CentralDifference step;
    step(body, 3000);
    CHECK(step.retries() == 0);
    CHECK(total_energy(body) < 1.5 * energy);
    CentralDifference without{{.step = 0.9 * before}};  // the step if it did not know them
    step(body);
    CHECK_THROWS_WITH(without(body, 3000),
                      says("with an eighth of the step too") && !says("(0 s)"));
  });
}

TEST_CASE("the stable step knows a pressure that is stiffer than the body", "[force]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = body_of<Rubber>(backend, mesh);
    double const before = stable_step(body);
    body.press(mesh.boundary("right"), 1e4);
    CHECK(stable_step(body) < before / 8);
  });
}

TEST_CASE("terms that say nothing or name no node of the body are refused", "[force][errors]") {
  auto body = body_of<Rubber>(MainBackend{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 2}}));
  CHECK_THROWS_WITH(body.add(Sets{}, Spring<double>{1}), says("body.add: there are no sets"));
  CHECK_THROWS_WITH(body.add(Sets{{0, 9}}, Spring<double>{1}), says("node 9") && says("0 to 8"));
  CHECK_THROWS_WITH(body.add(Sets{{-1, 2}}, Spring<double>{1}), says("node -1"));
  CHECK_THROWS_WITH(body.add(Sets{{0, 1}}, Spring<double>{NAN}), says("nan"));
  CHECK_THROWS_WITH(body.add([](auto const&, auto const&) { return nullptr; }),
                    says("there is no force term"));
  CHECK(body.parts().terms.empty());
  CHECK(body.parts().term_makers.empty());
}

}  // namespace pliant::test::force_terms_suite
