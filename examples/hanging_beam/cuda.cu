#include <pliant/cuda.hpp>

#include "hanging_beam/hanging_beam.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A hanging beam refines where it is stressed, on a GPU",
      [](scene::Options const& options) { hanging_beam::run(pliant::Cuda<double>{}, options); });
}
