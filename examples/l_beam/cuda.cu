#include <pliant/cuda.hpp>

#include "l_beam/l_beam.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "An L-shaped beam swings, and its mesh refines and coarsens, on a GPU",
      [](scene::Options const& options) { l_beam::run(pliant::Cuda<double>{}, options); });
}
