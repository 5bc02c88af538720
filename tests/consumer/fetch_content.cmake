# The library in host/ gets Pliant by FetchContent and exports itself; the program in guest/ finds an
# installed copy of it. The variables are those of consume.cmake.
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")
set(folder "${CMAKE_CURRENT_LIST_DIR}")
file(REMOVE_RECURSE "${BUILD}")

# install_host(<prefix> <argument>...)
function(install_host prefix)
  run("${CMAKE_COMMAND}" -S "${folder}/host" -B "${BUILD}/host" -G "${GENERATOR}"
      "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DPLIANT_SOURCE=${PLIANT_SOURCE}"
      "-DEigen3_DIR=${Eigen3_DIR}" ${ARGN})
  run("${CMAKE_COMMAND}" --install "${BUILD}/host" --prefix "${prefix}")
endfunction()

# Unless the host asks for it, its installation holds nothing of Pliant.
install_host("${BUILD}/without")
file(GLOB_RECURSE foreign "${BUILD}/without/*pliant*")
if(foreign)
  message(FATAL_ERROR "The host has not set PLIANT_INSTALL, but installs ${foreign}")
endif()

# What is switched off is not searched for.
file(STRINGS "${BUILD}/host/CMakeCache.txt" searched REGEX "^(OpenMP|CUDA|CMAKE_CUDA)")
if(searched)
  message(FATAL_ERROR "PLIANT_OPENMP and PLIANT_CUDA are off, but were searched for: ${searched}")
endif()

install_host("${BUILD}/prefix" -DPLIANT_INSTALL=ON)
file(GLOB_RECURSE exports "${BUILD}/prefix/share/*.cmake")
foreach(export IN LISTS exports)
  file(READ "${export}" text)
  foreach(path IN ITEMS "${PLIANT_SOURCE}" "${BUILD}")
    string(FIND "${text}" "${path}" found)
    if(NOT found EQUAL -1)
      message(FATAL_ERROR "${export} names ${path}, which its users do not have")
    endif()
  endforeach()
endforeach()
file(READ "${BUILD}/prefix/share/doc/host/LICENSE" licence)
if(licence MATCHES "Copyright")
  message(FATAL_ERROR "Pliant's licence replaces that of the host")
endif()

run("${CMAKE_COMMAND}" -S "${folder}/guest" -B "${BUILD}/guest" -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_PREFIX_PATH=${BUILD}/prefix"
    "-DEigen3_DIR=${Eigen3_DIR}")
run("${CMAKE_COMMAND}" --build "${BUILD}/guest")
run("${BUILD}/guest/guest")
