#include "support/laws.hpp"

namespace pliant::test {

template <int Dim>
Tensor<double, Dim> in_double(Tensor<float, Dim> const& a) {
  Tensor<double, Dim> b;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) b(i, j) = static_cast<double>(a(i, j));
  return b;
}

template <template <class> class L, int Dim>
void check_small_strain() {
  Random random(13);
  double const strain = 1e-4;
  for (int state = 0; state < 50; ++state) {
    auto const direction = random.tensor<Dim>(strain);
    Tensor<float, Dim> h;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) h(i, j) = static_cast<float>(direction(i, j));

    auto const p = in_double(stress(law_of_section_6<L, float>, h));
    double const w = static_cast<double>(energy_density(law_of_section_6<L, float>, h));

    // The same state: what was rounded into h is no error of the law.
    auto const exact = stress(law_of_section_6<L>, in_double(h));
    CHECK(largest<Dim>(p - exact) < 1e-6 * largest<Dim>(exact));
    CHECK(w == Approx(energy_density(law_of_section_6<L>, in_double(h))).epsilon(1e-6));
  }
}

TEST_CASE("single precision keeps its digits at small strain", "[law]") {
  check_small_strain<Hooke, 2>();
  check_small_strain<Hooke, 3>();
  check_small_strain<SaintVenantKirchhoff, 2>();
  check_small_strain<SaintVenantKirchhoff, 3>();
  check_small_strain<NeoHookean, 2>();
  check_small_strain<NeoHookean, 3>();
}

template <class T>
struct Fibres {
  T stiffness, direction[3];
  template <class S>
  PLIANT_HOST_DEVICE S energy(Tensor<S, 3> const& h) const {
    return stiffness * direction[0] * square(h(0, 0));
  }
};

TEST_CASE("law_cast changes the precision of every parameter", "[law]") {
  auto const single = law_cast<float>(NeoHookean<double>{1.1, 2.2});
  static_assert(std::same_as<decltype(single), NeoHookean<float> const>);
  CHECK(single.lambda == 1.1f);
  CHECK(single.mu == 2.2f);
  auto const back = law_cast<double>(single);
  CHECK(back.lambda == static_cast<double>(1.1f));
  auto const fibres = law_cast<float>(Fibres<double>{1, {2, 3, 4.5}});
  CHECK(fibres.direction[2] == 4.5f);
  CHECK(fibres.stiffness == 1);
}

}  // namespace pliant::test
