#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include <pliant/openmp.hpp>
#include <pliant/reference.hpp>

#include "support/formulations.hpp"
#include "support/problem.hpp"

// Whether OpenMP is ever slower than Reference: times over those of Reference in the same program, one
// call after the other in turns, the least of many. CMakeLists.txt builds it without AVX, with AVX2 and
// for this machine. Arguments, all optional: elements of the smallest mesh, of the largest one, and
// seconds for a line of the table.
namespace pliant::bench {

double now() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// The least seconds of one call of each.
template <class... Calls>
std::array<double, sizeof...(Calls)> in_turns(double seconds, Calls const&... calls) {
  constexpr int least_rounds = 10;
  std::array<double, sizeof...(Calls)> least;
  least.fill(std::numeric_limits<double>::infinity());
  double const end = now() + seconds;
  for (int round = 0; round < least_rounds || now() < end; ++round) {
    std::size_t k = 0;
    auto const time = [&](auto const& call) {
      double const start = now();
      call();
      least[k] = std::min(least[k], now() - start);
      ++k;
    };
    (time(calls), ...);
  }
  return least;
}

double sink;  // of results that nobody reads

/// What is timed of a formulation, on one backend.
template <class B, class F>
struct Work {
  using T = typename B::scalar;
  B backend;
  Problem<B, typename F::element>& p;

  Work(B const& on, int cells) : backend(on), p(Problem<B, typename F::element>::of(on, cells)) {}

  auto force() const {
    return [this, kernel = ForceKernel<GroupLaws<T, F>>{soft_laws<T, F>()}] {
      p.clear_forces(backend);
      backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u());
    };
  }
  auto tangent() const {
    return [this, kernel = TangentKernel<T, GroupLaws<T, F>>{soft_laws<T, F>(), T(1)}] {
      p.clear_forces(backend);
      backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u(), p.du());
    };
  }
  auto energy() const {
    return [this, kernel = EnergyKernel<GroupLaws<T, F>>{soft_laws<T, F>()}] {
      sink = backend.template sum_elements<1>(p.elements, kernel, p.rest(), p.u());
    };
  }
};

struct Settings {
  double smallest = 1e3, largest = 1e5, seconds = 0.3;
};
int slower = 0;

template <class F, class T>
void compare(char const* law, Settings const& settings) {
  using E = typename F::element;
  for (double elements = settings.smallest; elements <= settings.largest; elements *= 10) {
    int const cells = cells_for<E>(elements);
    Work<Reference<T>, F> const reference(Reference<T>{}, cells);
    Work<OpenMP<T>, F> const one(OpenMP<T>{{.threads = 1}}, cells),
        two(OpenMP<T>{{.threads = 2}}, cells);
    auto const line = [&](char const* what, auto const& work) {
      auto const t = in_turns(settings.seconds, work(reference), work(one), work(two));
      std::printf("%-7s  %-20s %-6s %-5s %7ld  %10.1f  %6.2f  %6.2f\n", what, law,
                  sizeof(T) == 4 ? "float" : "double", E::name(), element_count<E>(cells),
                  t[0] * 1e6, t[1] / t[0], t[2] / t[0]);
      std::fflush(stdout);
      slower += (t[1] > t[0]) + (t[2] > t[0]);
    };
    line("force", [](auto const& w) { return w.force(); });
    line("tangent", [](auto const& w) { return w.tangent(); });
    line("energy", [](auto const& w) { return w.energy(); });
  }
}
template <template <class> class L>
void compare_law(char const* name, Settings const& settings) {
  auto const each_precision = [&]<class E>(E) {
    compare<Usual<E, L>, float>(name, settings);
    compare<Usual<E, L>, double>(name, settings);
  };
  each_precision(Tet4{});
  each_precision(Hex8{});
  each_precision(Quad4{});
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  bench::Settings settings;
  double* const given[] = {&settings.smallest, &settings.largest, &settings.seconds};
  for (int k = 1; k < std::min(argc, 4); ++k) *given[k - 1] = std::atof(argv[k]);
  std::printf("%d bytes of SIMD; 1 thread and 2 threads: time over that of Reference\n",
              simd_bytes);
  std::printf("%-7s  %-20s %-6s %-5s %7s  %10s  %6s  %6s\n", "what", "law", "real", "cell",
              "number", "Ref. (us)", "1", "2");
  bench::compare_law<SaintVenantKirchhoff>("SaintVenantKirchhoff", settings);
  bench::compare_law<NeoHookean>("NeoHookean", settings);
  bench::compare_law<Ogden>("Ogden", settings);
  std::printf("%d times slower than Reference\n", bench::slower);
  return bench::slower != 0;
}
