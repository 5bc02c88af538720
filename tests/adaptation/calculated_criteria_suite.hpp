#pragma once

#include "adaptation/criteria.hpp"

namespace pliant::test::calculated_criteria_suite {

/// A user's region, of places at rest.
struct LeftOf {
  double x;
  template <class S, int Dim>
  PLIANT_HOST_DEVICE S operator()(Vector<S, Dim> const& place) const {
    return S(static_cast<builtin_scalar<S>>(x)) - place[0];
  }
};

static_assert(decltype(2.0 * RecoveredStress{} + RecoveredStress{})::unit == Unit::joule);
static_assert(decltype(VonMises{} / VonMises{})::unit == Unit::other);
static_assert(decltype(VonMises{} * StrainNorm{})::unit == Unit::pascal);
static_assert(decltype(1.0 - Rotation{})::unit == Unit::one);
static_assert(decltype(largest(VonMises{}, Rotation{}))::unit == Unit::other);

TEST_CASE("criteria are calculated with element by element", "[adaptation]") {
  on_each_element<AllBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(3);
    auto const u = Random(4).field<E::dim>(mesh.nodes.size(), 0.02);
    auto const of = [&](auto const& criterion) {
      return values_at<E>(backend, mesh, u, criterion);
    };
    auto const a = of(EdgeLengthRatio{}), b = of(StrainNorm{});

    auto const sum = of(EdgeLengthRatio{} + StrainNorm{}),
               difference = of(EdgeLengthRatio{} - 2.0 * StrainNorm{}),
               product = of(EdgeLengthRatio{} * StrainNorm{} / 4.0),
               ratio = of(1.0 / (StrainNorm{} + 0.5)), left = of(1.0 - EdgeLengthRatio{}),
               by_numbers = of(3.0 + EdgeLengthRatio{} * 2.0 - 1.0),
               quotient = of(EdgeLengthRatio{} / StrainNorm{});

    double const epsilon = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    auto const is = [&](double x) { return Approx(x).epsilon(epsilon).margin(epsilon); };
    for (std::size_t e = 0; e < a.size(); ++e) {
      CHECK(sum[e] == is(a[e] + b[e]));
      CHECK(difference[e] == is(a[e] - 2 * b[e]));
      CHECK(product[e] == is(a[e] * b[e] / 4));
      CHECK(ratio[e] == is(1 / (b[e] + 0.5)));
      CHECK(left[e] == is(1 - a[e]));
      CHECK(by_numbers[e] == is(2 + 2 * a[e]));
      CHECK(quotient[e] == Approx(a[e] / b[e]).epsilon(100 * epsilon));
    }
  });
}

TEST_CASE("conditions hold where all or any of their comparisons do", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    using Soft = Formulation<Quad4, Gauss<2>, Hooke>;
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto const mesh = distorted_mesh<Quad4>(6);
    auto const u = Random(4).field<2>(mesh.nodes.size(), 0.02);
    auto body = body_of<Soft>(backend, mesh);
    body.set_displacements(u);
    auto const a = evaluate<Quad4>(body, StrainNorm{}), b = evaluate<Quad4>(body, VonMises{}),
               c = evaluate<Quad4>(body, RecoveredStress{});
    auto const median = [](std::vector<double> v) {
      std::ranges::sort(v);
      return (v[v.size() / 2] + v[v.size() / 2 - 1]) / 2;
    };
    double const ma = median(a), mb = median(b), mc = median(c);

    auto const both = evaluate<Quad4>(body, all(StrainNorm{} > ma, mb > VonMises{}));
    auto const some =
        evaluate<Quad4>(body, any(all(StrainNorm{} > ma, VonMises{} > mb), RecoveredStress{} < mc));
    Body other{backend, mesh, soft, Group<Soft>{}, Group<Rubber>{}};
    other.set_displacements(u);
    Adaptation{when<Soft>(any(all(StrainNorm{} > ma, VonMises{} > mb), RecoveredStress{} < mc))
                   .holds()
                   .template become<Rubber>()}
        .now(other);
    auto const groups = other.template groups_of<Quad4>();

    int held = 0;
    for (std::size_t e = 0; e < a.size(); ++e) {
      CHECK(both[e] == (a[e] > ma && b[e] < mb));
      CHECK(some[e] == ((a[e] > ma && b[e] > mb) || c[e] < mc));
      CHECK(groups[e] == some[e]);
      held += both[e] == 1;
    }
    CHECK(held > 0);
    CHECK(held < static_cast<int>(a.size()) / 2 + 1);
  });
  CHECK_THROWS_AS(VonMises{} > NAN, Error);
}

TEST_CASE("a region limits a criterion to its elements", "[adaptation]") {
  on_each_element<FewBackends>([]<class B, class E>(B const& backend, E) {
    auto const mesh = distorted_mesh<E>(4);
    auto const u = Random(4).field<E::dim>(mesh.nodes.size(), 0.02);
    auto const whole = values_at<E>(backend, mesh, u, StrainNorm{});
    double const x = 0.23;
    Vector<double, E::dim> low, high, centre;
    for (int k = 0; k < E::dim; ++k) {
      low[k] = -9;
      high[k] = 9;
      centre[k] = 0.6;
    }
    high[0] = x;

    auto const left = values_at<E>(backend, mesh, u, inside(StrainNorm{}, LeftOf{x})),
               box = values_at<E>(backend, mesh, u, inside(StrainNorm{}, Box<E::dim>{low, high})),
               ball =
                   values_at<E>(backend, mesh, u, inside(StrainNorm{}, Ball<E::dim>{centre, 0.4}));

    auto const& elements = mesh.template elements<E>();
    int in_ball = 0, in_box = 0;
    for (std::size_t e = 0; e < whole.size(); ++e) {
      double middle = 0, squared = 0;
      for (std::size_t k = 0; k < E::dim; ++k) {
        double sum = 0;
        for (Index n : elements[e]) sum += mesh.nodes[static_cast<std::size_t>(n)][k] / E::nodes;
        if (k == 0) middle = sum;
        squared += square(sum - 0.6);
      }
      CHECK(std::isnan(left[e]) == (middle > x));
      CHECK(std::isnan(box[e]) == (middle > x));
      CHECK(std::isnan(ball[e]) == (squared > 0.16));
      if (middle < x) CHECK(left[e] == Approx(whole[e]).epsilon(1e-4));
      in_box += middle < x;
      in_ball += squared < 0.16;
    }
    CHECK(in_box > 0);
    CHECK(in_box < static_cast<int>(whole.size()));
    CHECK(in_ball > 0);
    CHECK(in_ball < static_cast<int>(whole.size()));
  });
}

TEST_CASE("a rule with a region refines there alone, by its own bulk", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, Hooke>;
    auto const mesh = mesh::rectangle<Tri3>({.size = {2, 1}, .cells = {8, 4}});
    auto body = body_of<F>(backend, mesh);
    auto u = mesh.nodes;  // the larger errors are on the right
    for (auto& p : u) p = {0.01 * p[0] * p[0] * p[0] * p[0], 0};
    body.set_displacements(u);

    Adaptation{
        when<F>(inside(RecoveredStress{}, Box<2>{{{{0}, {0}}}, {{{0.9}, {1}}}})).bulk(0.5).refine()}
        .now(body);

    auto const& refined = body.mesh();
    CHECK(refined.nodes.size() > mesh.nodes.size());
    for (std::size_t i = mesh.nodes.size(); i < refined.nodes.size(); ++i)
      CHECK(refined.nodes[i][0] < 1.01);
  });
}

}  // namespace pliant::test::calculated_criteria_suite
