#include "work_precision/slit_plate.hpp"

#include "work_precision/mesh_contest.hpp"

int main(int argc, char** argv) {
  using namespace pliant::bench;
  SlitPlate::find_reference();
  compare_meshes<SlitPlate>({argc, argv});
}
