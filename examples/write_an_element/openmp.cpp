#include <pliant/openmp.hpp>

#include "write_an_element.hpp"

int main() { write_an_element::run(pliant::OpenMP<double>{}); }
