#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <pliant/math/group_by_key.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test::host_threads_test {

using pliant::detail::for_each_on_host;
using pliant::detail::HostParts;

constexpr Index count = 1000, few = 10;

TEST_CASE("parts of a loop are all of it, each once", "[backend]") {
  for (int most : {1, 4}) {
    HostThreads const threads(most);
    std::vector<std::atomic<int>> visits(count);
    HostParts const parts(count, few);
    CHECK(parts.count() == (most == 1 ? 1 : 16));
    for (int loop = 0; loop < 50; ++loop)
      for_each_on_host(count, few, [&](Index i) { ++visits[static_cast<std::size_t>(i)]; });
    CHECK(std::ranges::all_of(visits, [](int n) { return n == 50; }));
    CHECK(HostParts(few, few).count() == 1);
    CHECK(HostParts(0, few).count() == 1);
  }
}

TEST_CASE("several threads take part in a loop", "[backend]") {
  HostThreads const threads(2);
  std::atomic<int> present = 0;
  HostThreads::run(2, [&](int) {  // each waits for the other
    ++present;
    while (present < 2) std::this_thread::yield();
  });
  CHECK(present == 2);
}

TEST_CASE("a loop throws what a serial one would have thrown first", "[backend][errors]") {
  HostThreads const threads(4);
  auto const refuse_from = [](Index bad) {
    for_each_on_host(count, few, [=](Index i) {
      if (i >= bad && i % 7 == bad % 7) throw std::runtime_error(std::to_string(i));
    });
  };
  for (Index bad : {0, 5, 333, count - 1}) CHECK_THROWS_WITH(refuse_from(bad), std::to_string(bad));
  CHECK_NOTHROW(refuse_from(count));
}

TEST_CASE("the outermost threads of a thread do its loops, and loops inside of loops are serial",
          "[backend]") {
  CHECK(HostThreads::now() == 1);
  HostThreads const outer(3);
  {
    HostThreads const inner(2);
    CHECK(HostThreads::now() == 3);
  }
  CHECK(HostThreads::now() == 3);
  std::atomic<int> parallel = 0;
  HostThreads::run(8, [&](int) {
    HostThreads const own(5);
    parallel += HostThreads::now() != 1 || HostParts(count, few).count() != 1;
  });
  CHECK(parallel == 0);
}

struct SerialBackend {
  using scalar = double;
};
struct TwoThreads {
  using scalar = double;
  int threads() const { return 2; }
};

TEST_CASE("a backend with threads on the host limits them", "[backend]") {
  CHECK(HostThreads::available() >= 1);
  HostThreads const two{TwoThreads{}};
  CHECK(HostThreads::now() == 2);
}

TEST_CASE("other backends leave all threads to the host", "[backend]") {
  HostThreads const all{SerialBackend{}};
  CHECK(HostThreads::now() == HostThreads::available());
}

TEST_CASE("small meshes are not worth a start of threads", "[backend]") {
  struct {
    std::tuple<std::vector<std::array<Index, 3>>, std::vector<std::array<Index, 4>>> tables;
  } mesh;
  std::get<0>(mesh.tables).resize(20000);
  std::get<1>(mesh.tables).resize(8000);
  {
    HostThreads const threads(mesh, 4);
    CHECK(HostThreads::now() == 1);
  }
  std::get<1>(mesh.tables).resize(12000);
  HostThreads const threads(mesh, 4);
  CHECK(HostThreads::now() == 4);
}

TEST_CASE("groups by a key are the same on several threads", "[backend]") {
  Random random(5);
  for (Index keys : {1, 700, 50000}) {
    std::vector<Index> key(100000);
    for (Index& k : key) k = static_cast<Index>(random.below(static_cast<unsigned>(keys)));
    auto const serial = pliant::detail::group_by_key(key, keys + 3);
    HostThreads const threads(4);
    auto const parallel = pliant::detail::group_by_key(key, keys + 3);
    CHECK(parallel.first == serial.first);
    CHECK(parallel.order == serial.order);
  }
}

}  // namespace pliant::test::host_threads_test
