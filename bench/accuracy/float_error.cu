#include <pliant/cuda.hpp>

#include "accuracy/float_error.hpp"

int main() { return float_error::main(pliant::Cuda<float>{}); }
