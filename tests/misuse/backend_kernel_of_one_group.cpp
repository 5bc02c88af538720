// expect: a kernel has operator\(\)\(GroupNumber<g>
#include <pliant/reference.hpp>

using namespace pliant;

// Of group 0 alone.
struct Same {
  template <class V>
  V operator()(GroupNumber<0>, V const& v) const {
    return v;
  }
};

int main() {
  Reference<double> const backend;
  Reference<double>::Elements<3> const elements{backend, {{0, 1, 2}}, 2, {0}, 3};
  auto const x = zeros<double>(backend, 12);
  auto sums = zeros<double>(backend, 12);
#ifndef PLIANT_MISUSE_OFF
  constexpr int groups = 2;
#else
  constexpr int groups = 1;
#endif
  backend.accumulate<groups>(elements, Same{}, NodeField<double, 2>{sums.data()},
                             NodeField<double const, 2>{x.data()});
}
