#include "work_precision/slit_plate.hpp"

int main(int argc, char** argv) {
  using namespace pliant::bench;
  SlitPlate::find_reference();
  compare_meshes<SlitPlate>({argc, argv});
}
