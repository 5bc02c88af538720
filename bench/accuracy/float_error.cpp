#include "accuracy/float_error.hpp"

#include <pliant/openmp.hpp>

int main() { return float_error::main(pliant::OpenMP<float>{}); }
