#include "work_precision/arm.hpp"

int main(int argc, char** argv) {
  using namespace pliant;
  bench::compare_ogden<bench::Arm, Tet4>("block with a thin arm, Tet4, Ogden", {argc, argv});
}
