#include "work_precision/arm.hpp"

int main(int argc, char** argv) {
  using namespace pliant;
  bench::swing_corotated<Tet4>("block with a thin arm, Tet4, Corotated", {argc, argv});
}
