#include <cstdlib>
#include <memory>
#include <numeric>
#include <vector>

#include <pliant/cuda.hpp>

#include "support/catch.hpp"

namespace pliant::test {

using detail::CudaContext;

TEST_CASE("scratch memory stays while there is enough of it, and grows by half", "[cuda]") {
  CudaContext context{CudaOptions{}};
  auto& scratch = context.scratch();
  std::byte* const first = scratch.take(100000);

  CHECK(scratch.take(100000) == first);
  CHECK(scratch.take(1) == first);
  std::byte* const second = scratch.take(100001);
  CHECK(scratch.take(150000) == second);
}

TEST_CASE("scratch memory that a recording uses is there when it is replayed", "[cuda]") {
  auto const context = std::make_shared<CudaContext>(CudaOptions{});
  auto& scratch = context->scratch();
  cudaStream_t const stream = context->stream()->get();
  constexpr std::size_t bytes = 1 << 20;
  auto const set = [&](std::byte* memory, int value) {
    REQUIRE(cudaMemsetAsync(memory, value, bytes, stream) == cudaSuccess);
  };
  auto const values_at = [&](std::byte const* memory) {
    std::vector<unsigned char> values(bytes);
    REQUIRE(cudaMemcpyAsync(values.data(), memory, bytes, cudaMemcpyDeviceToHost, stream) ==
            cudaSuccess);
    context->stream()->synchronize();
    return values;
  };
  std::byte *there = nullptr, *grown = nullptr;
  scratch.take(bytes);
  CudaRecording const uses(context, [&] { set(there = scratch.take(bytes), 1); });
  CudaRecording const grows(context, [&] { set(grown = scratch.take(2 * bytes), 2); });

  // What it gave back could be had again here.
  set(scratch.take(8 * bytes), 3);
  DeviceArray<unsigned char> others[] = {{context->stream(), bytes},
                                         {context->stream(), 2 * bytes}};
  uses.replay(1);
  grows.replay(1);

  CHECK(values_at(there) == std::vector<unsigned char>(bytes, 1));
  CHECK(values_at(grown) == std::vector<unsigned char>(bytes, 2));
  for (auto const& other : others) {
    std::vector<unsigned char> values(other.size());
    other.download(values);
    CHECK(values == std::vector<unsigned char>(other.size(), 0));
  }
}

TEST_CASE("small memory that is given back is had again, in the order of the stream", "[cuda]") {
  if (std::getenv("PLIANT_EXACT_MEMORY") != nullptr) return;
  auto const context = std::make_shared<CudaContext>(CudaOptions{});
  auto const numbers = [&](int from) {
    std::vector<int> values(1000);
    std::iota(values.begin(), values.end(), from);
    return values;
  };
  std::vector<int> kept(1000);
  int const* before = nullptr;
  {
    DeviceArray<int> const first(context->stream(), numbers(0));
    before = first.data();
  }
  DeviceArray<int> const second(context->stream(), numbers(7)), third(context->stream(), 1000);
  CHECK(second.data() == before);
  CHECK(third.data() != before);
  second.download(kept);
  CHECK(kept == numbers(7));
  third.download(kept);
  CHECK(kept == std::vector<int>(1000, 0));
}

TEST_CASE("what is given back while work is recorded is not had by others", "[cuda]") {
  auto const context = std::make_shared<CudaContext>(CudaOptions{});
  DeviceArray<int> kept(context->stream(), 1000);
  CudaRecording const sets(context, [&] {
    DeviceArray<int> const passing(context->stream(), 1000);
    REQUIRE(cudaMemcpyAsync(kept.data(), passing.data(), 1000 * sizeof(int),
                            cudaMemcpyDeviceToDevice, context->stream()->get()) == cudaSuccess);
  });
  std::vector<int> const values(1000, 3);
  DeviceArray<int> const other(context->stream(), values);
  std::vector<int> read(1000, 1);
  for (int i = 0; i < 3; ++i) sets.replay(1);
  other.download(read);
  CHECK(read == values);
  kept.download(read);
  CHECK(read == std::vector<int>(1000, 0));
}

}  // namespace pliant::test
