#include <pliant/math/spectrum.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test::spectrum_test {

template <int N>
double largest_entry(Tensor<double, N> const& a) {
  double m = 0;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) m = std::max(m, std::abs(a(i, j)));
  return m;
}
template <int N>
Tensor<double, N> diagonal_of(Vector<double, N> const& values) {
  auto d = Tensor<double, N>::zero();
  for (int i = 0; i < N; ++i) d(i, i) = values[i];
  return d;
}

template <int N>
void check_spectrum(Tensor<double, N> const& a) {
  auto const s = Spectrum<double, N>::of(a);
  auto const v = s.vectors;
  CHECK(largest_entry<N>(transpose(v) * v - Tensor<double, N>::identity()) < 4e-15);
  CHECK(determinant(v) == Approx(1).epsilon(4e-15));
  CHECK(largest_entry<N>(v * diagonal_of<N>(s.values) * transpose(v) - a) <
        8e-15 * largest_entry<N>(a));
}

TEST_CASE("a symmetric tensor is the sum of its eigenvalues along its eigenvectors", "[math]") {
  Random random;
  for (int k = 0; k < 2000; ++k) {
    double const size = std::pow(10.0, 4 * random());
    check_spectrum<2>(symmetric_part(random.tensor<2>(size)));
    check_spectrum<3>(symmetric_part(random.tensor<3>(size)));
  }
}

TEST_CASE("equal and vanishing eigenvalues are no exception", "[math]") {
  Random random;
  for (int k = 0; k < 500; ++k) {
    auto const turn = Spectrum<double, 3>::of(symmetric_part(random.tensor<3>(1))).vectors;
    for (auto const& values : {std::array{1.0, 1.0, 1.0},
                               {2.0, 2.0, 3.0},
                               {2.0, 2.0 + 1e-9, 2.0},
                               {0.0, 0.0, 1.0},
                               {1e-12, 1.0, -1.0}}) {
      auto const d = diagonal_of<3>({{{values[0]}, {values[1]}, {values[2]}}});
      check_spectrum<3>(d);
      check_spectrum<3>(symmetric_part(turn * d * transpose(turn)));
    }
  }
  CHECK(largest_entry<3>(Spectrum<double, 3>::of(Tensor<double, 3>::zero()).vectors -
                         Tensor<double, 3>::identity()) == 0);
}

TEST_CASE("a spectrum in single precision is diagonal to rounding", "[math]") {
  Random random;
  for (int k = 0; k < 2000; ++k) {
    auto const drawn = symmetric_part(random.tensor<3>(1));
    Tensor<float, 3> a;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) a(i, j) = static_cast<float>(drawn(i, j));
    auto const s = Spectrum<float, 3>::of(a);
    auto const diagonal = transpose(s.vectors) * a * s.vectors;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        CHECK(std::abs(diagonal(i, j) - (i == j ? s.values[i] : 0)) < 3e-6f);
  }
}

}  // namespace pliant::test::spectrum_test
