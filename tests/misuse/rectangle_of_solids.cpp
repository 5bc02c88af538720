// expect: mesh::rectangle makes plane elements
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
auto const sheet = mesh::rectangle<Hex8>({.size = {1, 1}, .cells = {2, 2}});
#else
auto const sheet = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {2, 2}});
#endif
