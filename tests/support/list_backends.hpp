#pragma once

#include <pliant/backend/host_lists.hpp>

#include "support/formulations.hpp"

// What suites of the verbs that write lists run on.
namespace pliant::test {

/// The algorithms of threads of the host, in parts that may have one entry each; the last part comes first.
struct InParts : Reference<double> {
  int threads() const { return 3; }
  void for_each_task(Index n, FunctionRef<void(Index)> f) const {
    for (Index k = n; k-- > 0;) f(k);
  }
  using Reference<double>::select;
  detail::ListParts parts(Index n) const { return {HostTasks(*this), n, 1}; }
  template <class F>
  void select(Index n, F const& f, Index* to, Index* count) const {
    detail::select_in_parts(parts(n), f, to, count);
  }
  template <class F>
  void scan(Index n, F const& f, Index* to) const {
    detail::scan_in_parts(parts(n), f, to);
  }
  void sort(Index n, std::uint64_t* keys, Index* values, int bits) const {
    detail::sort_in_parts(parts(n), keys, values, bits);
  }
};

/// Calls visit(backend) for each backend, and for several threads of the host.
template <class Visit>
void on_list_backends(Visit const& visit) {
  on_each_backend<Backends<double>>(visit);
#if !defined(__CUDACC__)
  SECTION("in parts") { visit(InParts{}); }
#if defined(_OPENMP)
  SECTION("three threads") { visit(OpenMP<double>{{.threads = 3}}); }
#endif
#endif
}

}  // namespace pliant::test
