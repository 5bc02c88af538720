#include "work_precision/arm.hpp"

int main(int argc, char** argv) {
  using namespace pliant;
  bench::compare_ogden<bench::Arm, Hex8>("block with a thin arm, Hex8, Ogden", {argc, argv});
}
