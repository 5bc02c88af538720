#include "formulation/catalogue_suite.hpp"

int main(int argc, char** argv) {
  return pliant::bench::run_catalogue<pliant::Tet10, pliant::Hex20, pliant::Hex27>(argc, argv);
}
