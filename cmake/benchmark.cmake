# Google Benchmark, as the target benchmark::benchmark; undefined when it is not found.
set(PLIANT_BENCHMARK_SOURCE "" CACHE PATH "Sources of Google Benchmark, where no package of it is")
if(PLIANT_BENCHMARK_SOURCE)
  set(BENCHMARK_ENABLE_TESTING OFF)
  set(BENCHMARK_ENABLE_INSTALL OFF)
  set(BENCHMARK_INSTALL_DOCS OFF)
  add_subdirectory("${PLIANT_BENCHMARK_SOURCE}" "${CMAKE_CURRENT_BINARY_DIR}/benchmark"
                   EXCLUDE_FROM_ALL SYSTEM)
else()
  find_package(benchmark QUIET)
endif()
