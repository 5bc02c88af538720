#include "formulation/catalogue_suite.hpp"

int main(int argc, char** argv) {
  return pliant::bench::run_catalogue<pliant::Wedge6, pliant::Pyramid5>(argc, argv);
}
