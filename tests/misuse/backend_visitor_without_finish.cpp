// expect: a visitor has `static constexpr int counters`
#include <pliant/reference.hpp>

using namespace pliant;

struct Widths {
  static constexpr int counters = 1;
  template <int G, class V>
  auto evaluate(GroupNumber<G>, V const& x) const {
    return Vector<double, 1>{{{x(1, 0) - x(0, 0)}}};
  }
#ifdef PLIANT_MISUSE_OFF
  template <int G, class Again, class Tally>
  void finish(GroupNumber<G>, Index, Vector<double, 1> const& width, Again const&,
              Tally const& tally) const {
    tally(0, width[0]);
  }
#endif
};

int main() {
  Reference<double> const backend;
  Reference<double>::Elements<3> const elements{backend, {{0, 1, 2}}, 1, {0}, 3};
  auto const x = zeros<double>(backend, 12);
  auto counters = zeros<double>(backend, 1);
  backend.visit<1>(elements, Widths{}, counters, NodeField<double const, 2>{x.data()});
}
