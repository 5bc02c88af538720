#include <pliant/openmp.hpp>

#include "write_a_criterion.hpp"

int main() { write_a_criterion::run(pliant::OpenMP<double>{}); }
