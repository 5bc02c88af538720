#include <pliant/openmp.hpp>

#include "hanging_solid/hanging_solid.hpp"

int main(int argc, char** argv) {
  return scene::main(
      argc, argv, "A solid beam hangs, and its mesh refines where its error is, on CPUs",
      [](scene::Options const& options) { hanging_solid::run(pliant::OpenMP<double>{}, options); });
}
