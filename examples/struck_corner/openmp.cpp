#include <pliant/openmp.hpp>

#include "struck_corner/struck_corner.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A sheet is struck at a corner and falls asleep, on CPUs",
      [](scene::Options const& options) { struck_corner::run(pliant::OpenMP<double>{}, options); });
}
