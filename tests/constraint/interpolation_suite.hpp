#pragma once

#include "support/flat.hpp"
#include "support/formulations.hpp"

namespace pliant::test::interpolation_suite {

/// Slaves of two to four masters each, at random: nodes 3, 7, 11, ... of `nodes`.
inline Interpolation random_interpolation(Index nodes, Random& random) {
  std::vector<Slave> slaves;
  for (Index s = 3; s < nodes; s += 4) {
    Slave slave{s, {}};
    auto const count = 2 + random.below(3);
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      auto master = static_cast<Index>(random.below(static_cast<std::size_t>(nodes)));
      if (master % 4 == 3) --master;
      slave.masters.emplace_back(master, 1.5 + random());
      sum += slave.masters.back().second;
    }
    for (auto& [master, weight] : slave.masters) weight /= sum;
    slaves.push_back(slave);
  }
  return Interpolation(compose(std::move(slaves)));
}
template <std::size_t Dim>
auto entries(FieldOf<Dim>& field) {
  return [&field](Index i, int k) -> double& {
    return field[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  };
}

TEST_CASE("apply_transpose is the transpose of apply, on the host", "[constraint]") {
  Random random(1);
  auto const p = random_interpolation(101, random);
  for (int round = 0; round < 5; ++round) {
    auto const v = random.field<3>(101, 1), f = random.field<3>(101, 1);
    auto pv = v, ptf = f;

    p.apply(entries(pv), 3);
    p.apply_transpose(entries(ptf), 3);

    // f·(P v) = (Pᵀ f)·v, where P ignores what slaves hold.
    CHECK(inner(f, pv) == Approx(inner(ptf, v)).epsilon(1e-13).margin(1e-12));
    CHECK(difference(pv, v) > 0.1);
    for (auto const& slave : p.slaves())
      CHECK(ptf[static_cast<std::size_t>(slave.node)] == Point<3>{});
  }
}

TEST_CASE("a row of the host has weights that apply uses", "[constraint]") {
  Random random(2);
  auto const p = random_interpolation(41, random);
  auto const v = random.field<1>(41, 1);
  auto pv = v;
  p.apply(entries(pv), 1);
  for (Index i = 0; i < 41; ++i) {
    double sum = 0;
    p.for_each_master(i, [&](Index master, double weight) {
      CHECK_FALSE(p.row_of(master).has_value());
      sum += weight * v[static_cast<std::size_t>(master)][0];
    });
    CHECK(pv[static_cast<std::size_t>(i)][0] == Approx(sum).epsilon(1e-14).margin(1e-15));
    CHECK(p.row_of(i).has_value() == (i % 4 == 3));
  }
}

/// A field as a backend keeps it.
template <class B, std::size_t Dim>
auto padded(B const& backend, FieldOf<Dim> const& field) {
  return upload(backend, flat<typename B::scalar>(field, node_stride, 0));
}

TEST_CASE("apply_transpose is the transpose of apply, on backends", "[constraint]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Random random(3);
    auto const host = random_interpolation(101, random);
    InterpolationOn<B> const p(backend, host);
    auto const v = rounded<T>(random.field<3>(101, 1)), f = rounded<T>(random.field<3>(101, 1));
    auto pv = padded(backend, v), ptf = padded(backend, f), added = padded(backend, f);
    auto pf = padded(backend, f), pf_of_two = padded(backend, f), pv_of_two = padded(backend, v);

    p.apply(backend, node_field<3>(pv));
    p.apply(backend, node_field<3>(pf));
    p.apply(backend, node_field<3>(pf_of_two), node_field<3>(pv_of_two));
    CHECK(download<T>(pf_of_two) == download<T>(pf));
    CHECK(download<T>(pv_of_two) == download<T>(pv));
    p.apply_transpose(backend, node_field<3>(ptf));
    p.add_transpose(backend, node_field<3>(added));

    double const rounding = 64 * double{std::numeric_limits<T>::epsilon()};
    auto const own_pv = per_node<3>(download<T>(pv), node_stride);
    auto const own_ptf = per_node<3>(download<T>(ptf), node_stride);
    auto const own_added = per_node<3>(download<T>(added), node_stride);
    CHECK(inner(f, own_pv) == Approx(inner(own_ptf, v)).epsilon(rounding).margin(rounding));
    auto host_pv = v, host_ptf = f;
    host.apply(entries(host_pv), 3);
    host.apply_transpose(entries(host_ptf), 3);
    CHECK(difference(own_pv, host_pv) < rounding);
    CHECK(difference(own_ptf, host_ptf) < rounding);
    for (std::size_t i = 0; i < f.size(); ++i)
      CHECK(own_added[i] == (i % 4 == 3 ? f[i] : own_ptf[i]));
    for (auto const& slave : host.slaves())
      CHECK(own_ptf[static_cast<std::size_t>(slave.node)] == Point<3>{});

    p.clear(backend, node_field<3>(added));
    CHECK(per_node<3>(download<T>(added), node_stride) == own_ptf);
  });
}

namespace {
/// What nodes read of forces that are handed on.
template <class T>
struct ReadForces {
  HandedOnForces<T, 3> forces;
  NodeField<T, 3> to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to.set(i, forces.at(i)); }
};
template <class T>
struct ClearForces {
  HandedOnForces<T, 3> forces;
  PLIANT_HOST_DEVICE void operator()(Index i) const { forces.set(i, Vector<T, 3>::zero()); }
};
}  // namespace

TEST_CASE("forces may be handed on where they are read", "[constraint]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    constexpr Index nodes = 101;
    Random random(6);
    auto const host = random_interpolation(nodes, random);
    InterpolationOn<B> p(backend, host);
    auto const u = random.field<3>(nodes, 1), v = random.field<3>(nodes, 1),
               f = random.field<3>(nodes, 1);
    auto own = padded(backend, f), added = padded(backend, f), read = padded(backend, u);

    p.list_by_node(backend, nodes);
    auto const forces = p.handed_on(node_field<3>(own));
    backend.for_each(nodes, ReadForces<T>{forces, node_field<3>(read)});
    p.add_transpose(backend, node_field<3>(added));

    CHECK(download<T>(read) == download<T>(added));
    CHECK(difference(per_node<3>(download<T>(read), node_stride), f) > 0.1);
    backend.for_each(nodes, ClearForces<T>{forces});
    auto const left = per_node<3>(download<T>(own), node_stride);
    auto const before = rounded<T>(f);
    for (std::size_t i = 0; i < left.size(); ++i)
      CHECK(left[i] == (host.row_of(static_cast<Index>(i)) ? before[i] : Point<3>{}));

    auto pu = padded(backend, u), pv = padded(backend, v), pu_of_two = padded(backend, u),
         pv_of_two = padded(backend, v);
    p.apply(backend, node_field<3>(pu), node_field<3>(pv));
    p.apply_and_clear(backend, node_field<3>(pu_of_two), node_field<3>(pv_of_two),
                      node_field<3>(own));
    CHECK(download<T>(pu_of_two) == download<T>(pu));
    CHECK(download<T>(pv_of_two) == download<T>(pv));
    CHECK(per_node<3>(download<T>(own), node_stride) == FieldOf<3>(nodes));
  });
}

TEST_CASE("constant fields are kept to the bit", "[constraint]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    Random random(4);
    auto const host = random_interpolation(101, random);
    auto const constant = rounded<T>(FieldOf<2>(101, {0.1, -1.0 / 3}));
    auto field = constant;
    for (auto const& slave : host.slaves()) field[static_cast<std::size_t>(slave.node)] = {9, 9};
    auto own = padded(backend, field);

    InterpolationOn<B>(backend, host).apply(backend, node_field<2>(own));
    host.apply(entries(field), 2);

    CHECK(field == constant);
    CHECK(per_node<2>(download<T>(own), node_stride) == constant);
  });
}

TEST_CASE("a mesh without slaves is left alone", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    InterpolationOn<B> const none(backend, Interpolation{});
    auto const field = Random(5).field<2>(7, 1);
    auto own = padded(backend, field);
    none.apply(backend, node_field<2>(own));
    none.apply_transpose(backend, node_field<2>(own));
    CHECK(none.empty());
    CHECK(per_node<2>(download<double>(own), node_stride) == field);
  });
}

}  // namespace pliant::test::interpolation_suite
