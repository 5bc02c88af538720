#include <pliant/cuda.hpp>

#include "rolling_load/rolling_load.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A mesh follows a load that rolls over a block, on a GPU",
      [](scene::Options const& options) { rolling_load::run(pliant::Cuda<double>{}, options); });
}
