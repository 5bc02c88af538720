// expect: all elements of a mesh live in the same dimension
#include <pliant/pliant.hpp>

using namespace pliant;

#ifndef PLIANT_MISUSE_OFF
Mesh<Tri3, Tet4> mesh_of_both;
#else
Mesh<Hex8, Tet4> mesh_of_both;
#endif
