#include <pliant/openmp.hpp>

#include "rolling_load/rolling_load.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A mesh follows a load that rolls over a block, on CPUs",
      [](scene::Options const& options) { rolling_load::run(pliant::OpenMP<double>{}, options); });
}
