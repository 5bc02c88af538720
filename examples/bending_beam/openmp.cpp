#include <pliant/openmp.hpp>

#include "bending_beam/bending_beam.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A beam bends and its elements change law, on CPUs",
      [](scene::Options const& options) { bending_beam::run(pliant::OpenMP<double>{}, options); });
}
