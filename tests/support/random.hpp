#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant::test {

/// Uniform numbers in [−1, 1], the same on every platform (those of the standard library are not).
class Random {
 public:
  explicit Random(unsigned seed = 1) : engine_(seed) {}
  double operator()() { return 2 * static_cast<double>(engine_()) / 4294967295.0 - 1; }
  /// A whole number in [0, n).
  std::size_t below(std::size_t n) { return engine_() % n; }

  template <int Dim>
  std::vector<Point<Dim>> field(std::size_t nodes, double size) {
    std::vector<Point<Dim>> values(nodes);
    for (auto& v : values)
      for (double& x : v) x = size * (*this)();
    return values;
  }
  template <int Dim>
  Tensor<double, Dim> tensor(double size) {
    Tensor<double, Dim> t;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) t(i, j) = size * (*this)();
    return t;
  }
  template <class Value>
  void shuffle(std::vector<Value>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937 engine_;
};

}  // namespace pliant::test
