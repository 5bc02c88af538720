#include "support/program.hpp"
#include "topology/trees_suite.hpp"

int main(int argc, char** argv) { return pliant::bench::run(argc, argv, pliant::bench::add_trees); }
