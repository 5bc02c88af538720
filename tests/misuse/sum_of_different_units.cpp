// expect: criteria of different units are neither added nor subtracted
#include <pliant/pliant.hpp>

using namespace pliant;

int main() {
#ifndef PLIANT_MISUSE_OFF
  (void)(VonMises{} + Rotation{});
#else
  (void)(VonMises{} / Rotation{} + VonMises{} / Rotation{});
#endif
}
