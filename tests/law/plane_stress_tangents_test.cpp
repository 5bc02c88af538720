#include "law/sheets.hpp"

namespace pliant::test::plane_stress_tangents_test {

TEST_CASE("the tangent of a sheet is the derivative of its stress", "[law]") {
  on_each_sheet<Ask::stress_and_tangent>([](AnySheet const& sheet) {
    Random random(18);
    for (int state = 0; state < 10; ++state) {
      auto const h = random_state<2>(random), along = random.tensor<2>(1);
      auto const dp = sheet.law.change(h, along);
      auto const slope =
          tensor_derivative<2>([&](double t) { return sheet.law.stress(h + t * along); }, 2e-3);
      CHECK(largest<2>(dp - slope) < 1e-8 * largest<2>(dp));
    }
  });
}

}  // namespace pliant::test::plane_stress_tangents_test
