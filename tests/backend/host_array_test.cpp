#include <limits>

#include <pliant/backend/host_array.hpp>

#include "support/catch.hpp"

namespace pliant::test {

TEST_CASE("host arrays refuse what no memory holds", "[backend]") {
  auto const most = std::numeric_limits<std::size_t>::max();
  CHECK_THROWS_WITH(HostArray<double>(most / 4), says("larger than memory"));
  CHECK_THROWS_WITH(HostArray<int>(most), says("larger than memory"));
#if !defined(__SANITIZE_ADDRESS__)  // which ends the program instead
  CHECK_THROWS_WITH(HostArray<double>(most / 16), says("out of memory") && says("bytes"));
#endif
}

}  // namespace pliant::test
