# Builds and runs the project in SOURCE, which gets Pliant in the WAY that CMakeLists.txt beside this
# file passes with the other variables.
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

file(REMOVE_RECURSE "${BUILD}")
if(WAY STREQUAL find_package)
  run("${CMAKE_COMMAND}" --install "${PLIANT_BUILD}" --prefix "${BUILD}/prefix")
  set(arguments "-DCMAKE_PREFIX_PATH=${BUILD}/prefix" "-DEigen3_DIR=${Eigen3_DIR}"
                "-DCHOLMOD=${CHOLMOD}")
else()
  set(arguments "-DPLIANT_SOURCE=${PLIANT_SOURCE}" "-DPLIANT_OPENMP=${OPENMP}" -DPLIANT_CUDA=OFF
                "-DPLIANT_EIGEN_INCLUDE=${PLIANT_EIGEN_INCLUDE}" "-DEigen3_DIR=${Eigen3_DIR}")
endif()
run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${BUILD}/build" -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" -DOPENMP=${OPENMP} ${arguments})
# What a processor's flags would bring is told where they are missing, once, and only there.
string(REGEX MATCHALL "no flag of parallel names a processor" told "${said}")
list(LENGTH told times)
set(expected 0)
if(OPENMP AND PROCESSOR MATCHES "x86_64|AMD64" AND NOT "$ENV{CXXFLAGS}" MATCHES "-m(arch|avx)")
  set(expected 1)
endif()
if(NOT times EQUAL expected)
  message(FATAL_ERROR "Configuring told ${times} times, not ${expected}, of missing flags:\n${said}")
endif()
run("${CMAKE_COMMAND}" "${BUILD}/build" -DCMAKE_CXX_FLAGS=-march=native)
if(said MATCHES "names a processor")
  message(FATAL_ERROR "Configuring tells of flags that are there:\n${said}")
endif()
run("${CMAKE_COMMAND}" "${BUILD}/build" "-DCMAKE_CXX_FLAGS=$ENV{CXXFLAGS}")
run("${CMAKE_COMMAND}" --build "${BUILD}/build")
run("${BUILD}/build/serial")
run("${BUILD}/build/rest")
if(OPENMP)
  run("${BUILD}/build/parallel")
endif()
