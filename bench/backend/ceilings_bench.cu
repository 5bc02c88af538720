#include <string>

#include <pliant/cuda.hpp>

#include "support/program.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// What this GPU can do at best: the rates that others are fractions of.
namespace pliant::bench {

/// Copies an array much larger than the cache; counts bytes read and bytes written.
void time_copy(benchmark::State& state, Cuda<float> const& backend) {
  using Row = pliant::detail::Piece<float, 4>;
  constexpr Index count = 1 << 26;
  auto from = zeros<Row>(backend, count), to = zeros<Row>(backend, count);
  measure(state, backend, [&] {
    backend.for_each(count, detail::CopyValue<Row>{from.data(), to.data()});
  });
  report_rate(state, "bytes_per_second", 2.0 * count * sizeof(Row));
}

/// Independent chains of fused multiply-adds in registers.
template <class T>
struct MultiplyAdds {
  static constexpr int chains = 8, rounds = 1024;
  static constexpr double flops = 2.0 * chains * rounds;
  T* sink;
  T a, b;

  __device__ void operator()(Index i) const {
    T x[chains];
    for (int c = 0; c < chains; ++c) x[c] = T(i % 7 + c);
#pragma unroll 8
    for (int r = 0; r < rounds; ++r)
#pragma unroll
      for (int c = 0; c < chains; ++c) x[c] = x[c] * a + b;
    T sum(0);
    for (int c = 0; c < chains; ++c) sum += x[c];
    if (sum == T(-1)) *sink = sum;  // never, but the compiler cannot know
  }
};

template <class T>
void time_multiply_adds(benchmark::State& state, Cuda<T> const& backend) {
  constexpr Index calls = 1 << 22;
  auto sink = zeros<T>(backend, 1);
  measure(state, backend, [&] {
    backend.for_each(calls, MultiplyAdds<T>{sink.data(), T(0.999), T(0.001)});
  });
  report_rate(state, "flops", calls * MultiplyAdds<T>::flops);
}

/// Adds a row to a node at random, of as many nodes as fit the cache.
template <class T>
struct AddToRandomNode {
  static constexpr Index nodes = 1 << 17;
  NodeField<T, 3> field;

  __device__ void operator()(Index i) const {
    std::uint32_t h = static_cast<std::uint32_t>(i) * 2654435761u;
    h = (h ^ h >> 15) * 2246822519u;
    T const row[3] = {T(1), T(2), T(3)};
    pliant::detail::add_to_node(field, static_cast<Index>((h ^ h >> 13) % nodes), row);
  }
};

/// Nodes to which three values each are added, per second: in single precision one vector
/// instruction, in double precision three.
template <class T>
void time_node_adds(benchmark::State& state, Cuda<T> const& backend) {
  constexpr Index calls = 1 << 24;
  auto values = zeros<T>(backend, std::size_t{node_stride} * AddToRandomNode<T>::nodes);
  measure(state, backend, [&] { backend.for_each(calls, AddToRandomNode<T>{{values.data()}}); });
  report_rate(state, "items_per_second", calls);
}

struct Nothing {
  PLIANT_HOST_DEVICE void operator()(Index) const {}
};

void add_ceilings() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role) {
    using T = typename std::remove_cvref_t<decltype(backend)>::scalar;
    std::string const precision = precision_name<T>();
    add_named("multiply-add/" + precision + "/" + name,
              [backend](benchmark::State& s) { time_multiply_adds(s, backend); });
    add_named("node-add/" + precision + "/" + name,
              [backend](benchmark::State& s) { time_node_adds(s, backend); });
  });
  on_each_backend<float>([](auto const& backend, std::string const& name, Role) {
    add_named("copy/" + name, [backend](benchmark::State& s) { time_copy(s, backend); });
    add_named("launch/" + name, [backend](benchmark::State& s) {
      measure_calls(s, backend, [&] { backend.for_each(1, Nothing{}); });
    });
    add_named("launch in graph/" + name, [backend](benchmark::State& s) {
      measure(s, backend, [&] { backend.for_each(1, Nothing{}); });
    });
  });
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, pliant::bench::add_ceilings);
}
