# Turns PLIANT_OPENMP into pliant_has_openmp.
set(pliant_has_openmp OFF)
if(PLIANT_OPENMP)
  find_package(OpenMP QUIET COMPONENTS CXX)
  if(OpenMP_CXX_FOUND)
    set(pliant_has_openmp ON)
  else()
    message(WARNING "OpenMP was not found, so pliant::openmp, its tests, examples and benchmarks "
                    "are left out. g++ brings OpenMP along; clang++ needs its runtime (Debian and "
                    "Ubuntu: apt-get install libomp-dev). -DPLIANT_OPENMP=OFF silences this.")
  endif()
endif()
