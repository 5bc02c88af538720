#pragma once

#include <pliant/solver/implicit/balance.hpp>

#include "adaptation/plane_bodies.hpp"
#include "solver/anchor.hpp"
#include "support/repeatable.hpp"

// Multigrid around a body without a matrix, by itself.
namespace pliant::test::multigrid_suite {

using Rubber = Formulation<Tet4, Gauss<1>, NeoHookean>;
using Bricks = Formulation<Hex8, Gauss<2>, Hooke>;

/// A body's matrix, and multigrid for it.
template <class TheBody>
struct Machine {
  static constexpr int dim = TheBody::dim;
  using Parts = typename TheBody::parts_type;
  using T = typename Parts::T;
  using Field = FieldOf<dim>;
  using Const = NodeField<T const, dim>;
  TheBody& body;
  Parts& parts = body.parts();
  detail::Balance<Parts> balance{parts, MassMatrix::lumped, 0};
  detail::ShiftedTangent<Parts> a{0, MassMatrix::lumped,      1, std::as_const(parts).u(),
                                  0, std::as_const(parts).u()};
  detail::Multigrid<Parts> multigrid;

  explicit Machine(TheBody& of, Preconditioner kind = Preconditioner::multigrid)
      : body(of), multigrid(parts, kind) {}
  void prepare() { multigrid.prepare(parts, balance.arrays(), a); }
  auto upload(Field const& values) const {
    return pliant::upload(parts.backend, parts.layout.padded(values));
  }
  /// Some values at the unknowns, zero elsewhere.
  Field random(unsigned seed) const {
    auto field = upload(Random(seed).field<dim>(static_cast<std::size_t>(body.nodes()), 1));
    detail::keep_unknowns(parts, node_field<dim>(field));
    return parts.layout.in_user_order(field);
  }
  /// A list over (node, 4), zero at what is no unknown.
  std::vector<T> unknowns_of(std::vector<T> const& list) const {
    auto field = pliant::upload(parts.backend, list);
    detail::keep_unknowns(parts, node_field<dim>(field));
    return download<T>(field);
  }
  Field times_matrix(Field const& x) {
    auto from = upload(x);
    a.apply(parts, node_field<dim>(from), node_field<dim>(balance.arrays().image));
    return unpadded(balance.arrays().image);
  }
  Field conditioned(Field const& r) {
    balance.arrays().residual = upload(r);
    multigrid.apply(parts, balance.arrays(), a, node_field<dim>(balance.arrays().residual));
    detail::keep_unknowns(parts, node_field<dim>(balance.arrays().conditioned));
    return unpadded(balance.arrays().conditioned);
  }
  Field unpadded(typename Parts::template Array<T> const& array) const {
    auto values = download<T>(array);
    values.resize(parts.layout.rest.size());
    return parts.layout.in_user_order(pliant::upload(parts.backend, values));
  }

  // Functions of the grid at a level, whose fields are lists over (node, 4).
  auto const& grid(int level) const { return multigrid.grids().grid(level); }
  /// P y, at the nodes of the finer level or the body's unknowns, from 0.
  std::vector<T> interpolated(int level, std::vector<T> const& y, std::size_t finer) const {
    auto const from = pliant::upload(parts.backend, y);
    auto to = zeros<T>(parts.backend, finer);
    bool const of_body = level == 0;
    parts.backend.for_each(
        static_cast<Index>(finer / node_stride),
        detail::AddInterpolated<T, dim>{grid(level),
                                        {to.data()},
                                        {from.data()},
                                        of_body ? parts.layout.mass.data() : nullptr,
                                        of_body ? parts.layout.held.data() : nullptr});
    return download<T>(to);
  }
  std::vector<T> restricted(int level, std::vector<T> const& b) const {
    auto const from = pliant::upload(parts.backend, b), nothing = zeros<T>(parts.backend, b.size());
    auto to = zeros<T>(parts.backend, rows(level));
    parts.backend.for_each(
        grid(level).nodes,
        detail::Restrict<T, dim>{grid(level), {to.data()}, {from.data()}, {nothing.data()}});
    return download<T>(to);
  }
  std::vector<T> times_stencil(int level, std::vector<T> const& x) const {
    auto const from = pliant::upload(parts.backend, x);
    auto to = zeros<T>(parts.backend, x.size());
    parts.backend.for_each(grid(level).nodes,
                           detail::StencilProduct<T, dim>{
                               multigrid.grids().matrix(level), {to.data()}, {from.data()}});
    return download<T>(to);
  }
  std::size_t rows(int level) const {
    return static_cast<std::size_t>(node_stride) * static_cast<std::size_t>(grid(level).nodes);
  }
  std::vector<T> random_rows(std::size_t count, unsigned seed) const {
    Random random(seed);
    std::vector<T> list(count, T(0));
    for (std::size_t i = 0; i < count; ++i)
      if (i % node_stride < dim) list[i] = static_cast<T>(random());
    return list;
  }
};

template <class T>
double dot(std::vector<T> const& a, std::vector<T> const& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}
template <std::size_t Dim>
double inner_product(std::vector<std::array<double, Dim>> const& a,
                     std::vector<std::array<double, Dim>> const& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) sum += a[i][k] * b[i][k];
  return sum;
}
template <class T>
double difference_of(std::vector<T> const& a, std::vector<T> const& b) {
  double most = a.size() == b.size() ? 0 : NAN;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(a[i] - b[i])));
  return most;
}
template <class T>
constexpr double digits = sizeof(T) == 8 ? 1e-11 : 3e-4;

/// Calls visit(body) for bodies that hang, mix, are held and are neither straight nor in order.
enum class Are { held, free };
template <class B, class Visit>
void on_bodies(B const& backend, Are are, Visit const& visit) {
  auto mesh = mixed_mesh(28);
  auto& corner =
      *std::ranges::max_element(mesh.nodes, {}, [](Point<2> const& x) { return x[0] + x[1]; });
  for (double& x : corner) x += 0.05;  // to a box that holds the middle of no element
  auto plane = plane_body(backend, mesh);
  if (are == Are::held) {
    plane.hold(plane.mesh().boundary("left"), 1);
    plane.clamp(plane.mesh().boundary("bottom"));
  }
  refine(plane, {{0, 5, 6, 11}, {3, 9, 20}});
  plane.set_displacements(Random(1).field<2>(static_cast<std::size_t>(plane.nodes()), 1e-3));
  visit(plane);
  auto solid = body_of<Rubber>(backend, distorted_mesh<Tet4>(9));
  if (are == Are::held) solid.clamp(solid.mesh().boundary("left"));
  visit(solid);
}

TEST_CASE("restriction is the transpose of interpolation", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_bodies(backend, Are::held, [&]<class TheBody>(TheBody& body) {
      using T = typename B::scalar;
      Machine<TheBody> const machine(body);
      for (int level = 0; level + 1 < machine.multigrid.levels(); ++level) {
        auto const finer = level == 0 ? body.parts().layout.rest.size() : machine.rows(level - 1);
        auto const y = machine.random_rows(machine.rows(level), 1);
        // Interpolation leaves what is held alone, as restriction passes over it.
        auto const b = machine.random_rows(finer, 2);
        auto const unknown = level == 0 ? machine.unknowns_of(b) : b;
        double const size = std::sqrt(static_cast<double>(finer));
        CHECK(dot(machine.interpolated(level, y, finer), b) ==
              Approx(dot(y, machine.restricted(level, unknown))).margin(digits<T> * size));
      }
    });
  });
}

TEST_CASE("interpolation carries any linear field over", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_bodies(backend, Are::free, [&]<class TheBody>(TheBody& body) {
      using T = typename B::scalar;
      Machine<TheBody> const machine(body);
      REQUIRE(machine.multigrid.levels() >= 3);
      // (x, y, z) ↦ (y, 2 x + 1, z)
      auto const field_at = [](std::vector<T> list) {
        for (std::size_t i = 0; i < list.size(); i += node_stride) {
          std::swap(list[i], list[i + 1]);
          list[i + 1] = 2 * list[i + 1] + 1;
        }
        return list;
      };
      for (int level = 0; level + 1 < machine.multigrid.levels(); ++level) {
        auto const rest_of = [&](int at) {
          return download<T>(at < 0 ? body.parts().layout.rest
                                    : machine.multigrid.grids().rest(at));
        };
        auto expected = field_at(rest_of(level - 1));
        if (level == 0) expected = machine.unknowns_of(expected);
        auto const found = machine.interpolated(level, field_at(rest_of(level)), expected.size());
        CHECK(difference_of(found, expected) < digits<T>);
      }
    });
  });
}

/// It is, and nearly the inverse of the matrix.
template <class M>
void check_symmetry(M& machine) {
  for (double inertia : {0.0, 50.0}) {
    machine.a.inertia = inertia;
    machine.prepare();
    for (unsigned seed = 1; seed <= 3; ++seed) {
      auto const r = machine.random(seed), s = machine.random(seed + 10);
      auto const mr = machine.conditioned(r), ms = machine.conditioned(s);
      double const size = std::sqrt(inner_product(r, mr) * inner_product(s, ms));
      CHECK(inner_product(r, mr) > 0);
      CHECK(inner_product(s, mr) ==
            Approx(inner_product(r, ms)).margin(digits<typename M::T> * size));
      double const share =
          inner_product(r, machine.conditioned(machine.times_matrix(mr))) / inner_product(r, mr);
      CHECK(share > 0.3);
      CHECK(share < 1.2);
    }
  }
}

TEST_CASE("multigrid is symmetric and positive definite", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_bodies(backend, Are::held, [&]<class TheBody>(TheBody& body) {
      Machine<TheBody> machine(body);
      check_symmetry(machine);
    });
  });
}

/// Calls visit(body) for bodies of quadratic elements that are held here and there, with springs and past.
template <class B, class Visit>
void on_quadratic_bodies(B const& backend, Visit const& visit) {
  auto const hold = [](auto& body, double size) {
    constexpr int dim = std::remove_cvref_t<decltype(body)>::dim;
    body.clamp(body.mesh().boundary("left"));
    body.hold(body.mesh().boundary("bottom"), 1 << (dim - 1));
    body.hold(std::vector<Index>{body.mesh().boundary("top")[0][0]}, 1);
    body.set_displacements(
        Random(1).template field<dim>(static_cast<std::size_t>(body.nodes()), size));
  };
  auto plane = body_of<Formulation<Quad8, Gauss<3>, NeoHookean>>(backend, distorted_mesh<Quad8>(9));
  hold(plane, 1e-4);
  std::vector<std::array<Index, 1>> nodes;
  for (Index i = 0; i < plane.nodes(); i += 3) nodes.push_back({i});
  plane.add(nodes, Anchor<double>{300});
  visit(plane);
  auto solid = body_of<Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>>(
      backend, distorted_mesh<Tet10>(4));
  hold(solid, 1e-4);
  visit(solid);
}

TEST_CASE("p-multigrid is symmetric and positive definite", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_quadratic_bodies(backend, [&]<class TheBody>(TheBody& body) {
      Machine<TheBody> machine(body, Preconditioner::p_multigrid);
      check_symmetry(machine);
    });
  });
}

TEST_CASE("the matrix of linear elements on the same cells is Galerkin's", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    on_quadratic_bodies(backend, [&]<class TheBody>(TheBody& body) {
      using T = typename B::scalar;
      constexpr int dim = TheBody::dim;
      Machine<TheBody> machine(body, Preconditioner::p_multigrid);
      machine.a.inertia = 50;
      // A force term couples no nodes here, and masses count as lumped.
      machine.prepare();
      auto& parts = body.parts();
      auto const& corners = machine.multigrid.corner_level();
      auto const count = static_cast<std::size_t>(corners.count());
      CHECK(count < static_cast<std::size_t>(body.nodes()) / 2);
      for (unsigned seed = 1; seed <= 3; ++seed) {
        auto x = pliant::upload(backend, machine.random_rows(node_stride * count, seed));
        auto fine = zeros<T>(backend, parts.layout.rest.size());
        auto expected = zeros<T>(backend, x.size()), found = zeros<T>(backend, x.size());
        auto& image = machine.balance.arrays().image;
        corners.interpolate(parts, {x.data()}, node_field<dim>(fine));
        machine.a.apply(parts, node_field<dim>(fine), node_field<dim>(image));
        corners.restrict(parts, node_field<dim>(image), node_field<dim>(expected));
        backend.for_each(corners.count(), detail::SlicedProduct<T, dim>{
                                              corners.matrix(), {found.data()}, {x.data()}});
        auto const one = download<T>(expected), other = download<T>(found);
        CHECK(difference_of(one, other) < digits<T> * std::sqrt(dot(one, one)));
      }
    });
  });
}

TEST_CASE("linear fields of corners are linear at all nodes of their cells", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto body = body_of<Formulation<Hex27, Gauss<3>, Hooke>>(backend, distorted_mesh<Hex27>(3));
    Machine<decltype(body)> const machine(body, Preconditioner::p_multigrid);
    auto const& corners = machine.multigrid.corner_level();
    auto found = zeros<T>(backend, body.parts().layout.rest.size());
    corners.interpolate(body.parts(), {corners.rest().data()}, node_field<3>(found));
    CHECK(difference_of(download<T>(found), download<T>(body.parts().layout.rest)) < digits<T>);
  });
}

TEST_CASE("matrices of grids are Galerkin's where elements lie in boxes", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto body = body_of<Bricks>(backend, mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {9, 8, 8}}));
    body.clamp(body.mesh().boundary("left"));
    body.hold(body.mesh().boundary("bottom"), 2);
    Machine<decltype(body)> machine(body);
    machine.a.inertia = 3;
    machine.prepare();
    REQUIRE(machine.multigrid.levels() >= 3);
    auto const rest = body.parts().layout.rest.size();
    for (unsigned seed = 1; seed <= 3; ++seed) {
      auto const x = machine.random_rows(machine.rows(0), seed);
      auto fine = pliant::upload(backend, machine.interpolated(0, x, rest));
      auto& image = machine.balance.arrays().image;
      machine.a.apply(body.parts(), node_field<3>(fine), node_field<3>(image));
      auto pulls = download<T>(image);
      pulls.resize(rest);
      auto const expected = machine.restricted(0, pulls), found = machine.times_stencil(0, x);
      double const size = std::sqrt(dot(expected, expected));
      CHECK(difference_of(expected, found) < digits<T> * size);

      auto const y = machine.random_rows(machine.rows(1), seed);
      auto const coarse =
          machine.restricted(1, machine.times_stencil(0, machine.interpolated(1, y, x.size())));
      CHECK(difference_of(coarse, machine.times_stencil(1, y)) <
            digits<T> * std::sqrt(dot(coarse, coarse)));
    }
  });
}

TEST_CASE("a dense inverse passes over what is no unknown, and turns negative values", "[solver]") {
  Eigen::MatrixXd a(3, 3);
  a << 4, 2, 0, 2, 5, 0, 0, 0, 0;
  auto const inverse = detail::inverse_of_definite(a);
  CHECK((inverse * a - Eigen::Vector3d(1, 1, 0).asDiagonal().toDenseMatrix()).norm() < 1e-14);
  Eigen::MatrixXd b(2, 2);
  b << 1, 2, 2, 1;  // −1 along (1, −1), 3 along (1, 1)
  Eigen::MatrixXd expected(2, 2);
  expected << 2.0 / 3, -1.0 / 3, -1.0 / 3, 2.0 / 3;
  CHECK((detail::inverse_of_definite(b) - expected).norm() < 1e-14);
  b << 1, 1, 1, 1;
  expected << 0.25, 0.25, 0.25, 0.25;
  CHECK((detail::inverse_of_definite(b) - expected).norm() < 1e-14);
}

}  // namespace pliant::test::multigrid_suite
