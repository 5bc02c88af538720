#include <pliant/openmp.hpp>

#include "write_a_law.hpp"

int main() { write_a_law::run(pliant::OpenMP<double>{}); }
