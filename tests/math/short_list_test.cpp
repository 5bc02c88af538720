#include <vector>

#include <pliant/math/short_list.hpp>

#include "support/catch.hpp"

namespace pliant::test {

TEST_CASE("a short list has what was put into it, up to its capacity", "[math]") {
  ShortList<int, 3> list{4, 5};
  list.push_back(6);

  CHECK(std::vector(list.begin(), list.end()) == std::vector{4, 5, 6});
  CHECK(list.size() == 3);
  CHECK(list[1] == 5);
  CHECK(list.back() == 6);
  CHECK(ShortList<int, 3>().empty());
  CHECK_THROWS_AS((ShortList<int, 3>{1, 2, 3, 4}), Error);
}

}  // namespace pliant::test
