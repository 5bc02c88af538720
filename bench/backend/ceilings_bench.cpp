#include <string>

#include "support/program.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// What this CPU can do at best: the rates that others are fractions of.
namespace pliant::bench {

/// Copies an array much larger than any cache; counts bytes read and bytes written.
template <class B>
void time_copy(benchmark::State& state, B const& backend) {
  constexpr Index count = 1 << 25;
  HostArray<double> from(count), to(count);
  measure(state, backend, [&] {
    backend.for_each(count, pliant::detail::CopyValue<double>{from.data(), to.data()});
    benchmark::ClobberMemory();
  });
  report_rate(state, "bytes_per_second", 2.0 * count * sizeof(double));
}

#if defined(_OPENMP)
/// Independent chains of fused multiply-adds in registers, a pack of numbers each.
template <class T>
struct MultiplyAdds {
  static constexpr int chains = 16, rounds = 512;
  static constexpr double flops = 2.0 * chains * rounds * Pack<T>::lanes;
  T* sink;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Pack<T> const a(T(0.999)), b(T(0.001));
    Pack<T> x[chains];
    for (int c = 0; c < chains; ++c) x[c] = Pack<T>(T(i % 7 + c));
    for (int r = 0; r < rounds; ++r) step(x, a, b, std::make_index_sequence<chains>());
    Pack<T> sum(0);
    for (int c = 0; c < chains; ++c) sum += x[c];
    if (sum[0] == T(-1)) *sink = sum[1];  // never, but the compiler cannot know
  }

 private:
  template <std::size_t... C>
  PLIANT_HOST_DEVICE static void step(Pack<T> (&x)[chains], Pack<T> a, Pack<T> b,
                                      std::index_sequence<C...>) {
    ((x[C] = x[C] * a + b), ...);
  }
};

template <class T>
void time_multiply_adds(benchmark::State& state, OpenMP<T> const& backend) {
  constexpr Index calls = 1 << 13;
  T sink = 0;
  measure(state, backend, [&] { backend.for_each(calls, MultiplyAdds<T>{&sink}); });
  report_rate(state, "flops", calls * MultiplyAdds<T>::flops);
}
#endif

void add_ceilings() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role != Role::scalar)
      add_named("copy/" + name, [backend](benchmark::State& s) { time_copy(s, backend); });
  });
#if defined(_OPENMP)
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using T = typename std::remove_cvref_t<decltype(backend)>::scalar;
    if constexpr (std::same_as<std::remove_cvref_t<decltype(backend)>, OpenMP<T>>)
      if (role != Role::scalar)
        add_named("multiply-add/" + precision_name<T>() + "/" + name,
                  [backend](benchmark::State& s) { time_multiply_adds(s, backend); });
  });
#endif
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, pliant::bench::add_ceilings);
}
