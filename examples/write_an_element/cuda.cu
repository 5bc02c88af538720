#include <pliant/cuda.hpp>

#include "write_an_element.hpp"

int main() { write_an_element::run(pliant::Cuda<double>{}); }
