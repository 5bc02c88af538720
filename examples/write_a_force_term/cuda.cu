#include <pliant/cuda.hpp>

#include "write_a_force_term.hpp"

int main() { write_a_force_term::run(pliant::Cuda<double>{}); }
