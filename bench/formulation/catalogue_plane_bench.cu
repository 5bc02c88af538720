#include "formulation/catalogue_suite.hpp"

int main(int argc, char** argv) {
  return pliant::bench::run_catalogue<pliant::Tri6, pliant::Quad8, pliant::Quad9>(argc, argv);
}
