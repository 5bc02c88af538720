#include <host.hpp>

#include <pliant/math/matrix.hpp>

int main() {
  auto const identity = pliant::Matrix<double, 2, 2>::identity();
  return version_of_pliant() > 0 && identity(1, 1) == 1 ? 0 : 1;
}
