#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#if defined(TESTS_NEED_GPU)
#include <cuda_runtime_api.h>

#include <cstdio>
#endif

int main(int argc, char** argv) {
#if defined(TESTS_NEED_GPU)
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::puts("Skipped: there is no GPU that CUDA can use.");
    return 77;
  }
#endif
  // Catch2 returns how many tests failed, and 77 of them must not read as skipped.
  return Catch::Session().run(argc, argv) == 0 ? 0 : 1;
}
