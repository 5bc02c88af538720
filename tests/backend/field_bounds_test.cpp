// What debug builds check, in any build.
#undef NDEBUG

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <vector>

#include <pliant/backend/field.hpp>

#include "support/catch.hpp"

namespace pliant::test {

/// Whether f() ends the program by abort.
template <class F>
bool aborts(F const& f) {
  std::fflush(nullptr);
  pid_t const child = fork();
  if (child == 0) {
    std::signal(SIGABRT, SIG_DFL);
    std::fclose(stderr);
    f();
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

TEST_CASE("debug builds refuse indices beyond a field", "[backend]") {
  std::vector<double> values(5 * node_stride, 1.0);
  auto const field = node_field<3>(values);
  ElementField<double, 2> const columns{values.data(), 10};
  static_assert(std::is_same_v<decltype(node_field<2>(std::as_const(values)))::value_type, double>);
  CHECK(field.nodes == 5);

  CHECK_FALSE(aborts([&] { field(4, 2) = 2; }));
  CHECK_FALSE(aborts([&] { columns(9, 1) = 2; }));
  CHECK_FALSE(aborts([&] { NodeField<double, 3>{values.data()}.at(4); }));

  CHECK(aborts([&] { field(5, 0) = 2; }));
  CHECK(aborts([&] { field(-1, 0) = 2; }));
  CHECK(aborts([&] { field(0, 3) = 2; }));
  CHECK(aborts([&] { field.set(5, {}); }));
  CHECK(aborts([&] { field.at(5); }));
  CHECK(aborts([&] { columns(10, 0) = 2; }));
  CHECK(aborts([&] { columns(0, 2) = 2; }));
  CHECK(aborts([&] { NodeField<double, 3>{values.data()}(-1, 0) = 2; }));
}

}  // namespace pliant::test
