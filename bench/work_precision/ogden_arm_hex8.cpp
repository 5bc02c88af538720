#include "work_precision/arm.hpp"

int main(int argc, char** argv) {
  using namespace pliant;
  bench::swing_under_ogden<Hex8>("block with a thin arm, Hex8, Ogden", {argc, argv});
}
