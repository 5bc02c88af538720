#include "work_precision/arm.hpp"

int main(int argc, char** argv) {
  using namespace pliant;
  bench::swing_corotated<Hex8>("block with a thin arm, Hex8, Corotated", {argc, argv});
}
