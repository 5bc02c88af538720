#include "adaptation/shapes_suite.hpp"
#include "support/program.hpp"

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, pliant::bench::add_shapes);
}
