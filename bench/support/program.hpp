#pragma once

#include <cstdio>

#include <benchmark/benchmark.h>

#include <pliant/error.hpp>

namespace pliant::bench {

/// The main function of a benchmark program: registers, then runs what the command line asks for.
template <class Register>
int run(int argc, char** argv, Register const& register_all) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    register_all();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
  } catch (Error const& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace pliant::bench
