// expect: without .?(AVX|avx).? enabled changes the ABI
// flags: -march=x86-64 -Wall -Wextra -Wpsabi -Werror
#include <pliant/openmp/transpose.hpp>

// Packs of elements set off no warning of their own, and leave those of others on.
using namespace pliant;

template <class T>
T logarithm_of_node(T const* nodes) {
  Index index[Pack<T>::lanes] = {};
  typename Pack<T>::Register r[4];
  detail::gather_nodes<T, Pack<T>::lanes>(nodes, index, r);
  return log1p(Pack<T>(r[0]) + sqrt(Pack<T>(r[1])))[0];
}
template float logarithm_of_node(float const*);
template double logarithm_of_node(double const*);

#ifndef PLIANT_MISUSE_OFF
typedef double Vector4 __attribute__((vector_size(32)));
Vector4 twice(Vector4 const& a) { return a + a; }
Vector4 fourfold(Vector4 const& a) { return twice(a) + twice(a); }
#endif
