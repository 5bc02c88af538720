#include <pliant/pliant.hpp>

#if defined(WANT_OPENMP)
#include <pliant/openmp.hpp>
#elif defined(_OPENMP)
#error "pliant::pliant alone must not bring OpenMP along"
#endif

#include <cstdio>

static_assert(pliant::version.major == 0);

int main() {
  std::printf("Pliant %d.%d.%d\n", pliant::version.major, pliant::version.minor,
              pliant::version.patch);
}
