#include <stdexcept>

#include "support/formulations.hpp"

// A functor that throws does not end the program: the exception leaves the verb, and it is the one
// that a serial loop would have met first.
namespace pliant::test {

struct Refusal : std::runtime_error {
  explicit Refusal(Index i) : std::runtime_error("refused " + std::to_string(i)) {}
};

constexpr Index count = 20000, patch = 2048, first_bad = 5 * patch, second_bad = 7 * patch;

inline void refuse(Index i) {
  if (i == first_bad || i == second_bad) throw Refusal(i);
}

struct RefuseNodes {
  double operator()(Index i) const {
    refuse(i);
    return 1;
  }
};
struct RefuseNumbers {
  Index operator()(Index i) const {
    refuse(i);
    return 1;
  }
};
/// The first component of a node is its number.
struct RefuseElements {
  static constexpr int counters = 1;
  template <int G, class V>
  V operator()(GroupNumber<G>, V const& x) const {
    look_at(x);
    return x;
  }
  template <int G, class V>
  auto evaluate(GroupNumber<G>, V const& x) const {
    look_at(x);
    return Vector<std::remove_cvref_t<decltype(x(0, 0))>, 1>{};
  }
  template <int G, class... A>
  void finish(GroupNumber<G>, A const&...) const {}

  template <class V>
  static void look_at(V const& x) {
    using P = std::remove_cvref_t<decltype(x(0, 0))>;
    for (int l = 0; l < P::lanes; ++l) refuse(static_cast<Index>(x(0, 0)[l]));
  }
};
struct RefuseEnergies : RefuseElements {
  template <int G, class V>
  auto operator()(GroupNumber<G>, V const& x) const {
    look_at(x);
    return x(0, 0);
  }
};
struct RefuseToFinish : RefuseElements {
  template <int G, class V>
  auto evaluate(GroupNumber<G>, V const& x) const {
    return Vector<std::remove_cvref_t<decltype(x(0, 0))>, 1>{};
  }
  template <int G, class... A>
  void finish(GroupNumber<G>, Index e, A const&...) const {
    refuse(e);
  }
};

TEST_CASE("an exception thrown inside a verb leaves it as from a serial loop", "[openmp]") {
  std::vector<std::array<Index, 2>> connectivity;
  for (Index e = 0; e < count; ++e) connectivity.push_back({e, e + 1});
  std::vector<Tag> const tags(count, 0);
  for (int threads : {1, 2, 5}) {
    INFO(threads << " threads");
    OpenMP<double> const backend{{.threads = threads}};
    OpenMP<double>::Elements<2> const elements{backend, connectivity, 1, tags, count + 1};
    HostArray<Index> list(2 * count + 1);
    HostArray<double> x(node_stride * (count + 1)), counters(1),
        out(node_stride * static_cast<std::size_t>(count + 1 + elements.scratch_nodes()));
    for (Index i = 0; i <= count; ++i) x.data()[node_stride * i] = i;
    NodeField<double const, 1> const field{x.data()};
    NodeField<double, 1> const sums{out.data()};
    auto const first = says("refused " + std::to_string(first_bad));

    for (int round = 0; round < 3; ++round) {
      CHECK_THROWS_WITH(backend.for_each(count, RefuseNodes{}), first);
      CHECK_THROWS_WITH(backend.sum(count, RefuseNodes{}), first);
      CHECK_THROWS_WITH(backend.maximum(count, RefuseNodes{}), first);
      CHECK_THROWS_WITH(backend.scan(2 * count, RefuseNumbers{}, list.data()), first);
      CHECK_THROWS_WITH(backend.select(2 * count, RefuseNumbers{}, list.data(), list.data()),
                        first);
      CHECK_THROWS_WITH(backend.accumulate<1>(elements, RefuseElements{}, sums, field), first);
      CHECK_THROWS_WITH(backend.sum_elements<1>(elements, RefuseEnergies{}, field), first);
      CHECK_THROWS_WITH(backend.visit<1>(elements, RefuseElements{}, counters, field), first);
      CHECK_THROWS_WITH(backend.visit<1>(elements, RefuseToFinish{}, counters, field), first);
    }
    CHECK_THROWS_AS(backend.for_each(count, RefuseNodes{}), Refusal);  // as it was thrown
    CHECK(backend.sum(first_bad, RefuseNodes{}) == first_bad);         // and no trace is left
  }
}

}  // namespace pliant::test
