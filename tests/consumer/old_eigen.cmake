# Eigen 3.3.9, as a package and as headers, has to be refused with the version in the message, by the
# source tree and by an installed copy. The variables are those of consume.cmake.
file(REMOVE_RECURSE "${BUILD}")
set(old "${BUILD}/eigen")
file(WRITE "${old}/Eigen3Config.cmake" "add_library(Eigen3::Eigen INTERFACE IMPORTED)\n")
file(WRITE "${old}/Eigen3ConfigVersion.cmake"
     "set(PACKAGE_VERSION 3.3.9)\n"
     "if(NOT PACKAGE_FIND_VERSION VERSION_GREATER 3.3.9)\n"
     "  set(PACKAGE_VERSION_COMPATIBLE TRUE)\n"
     "endif()\n")
file(WRITE "${old}/Eigen/Core" "")
file(WRITE "${old}/Eigen/src/Core/util/Macros.h"
     "#define EIGEN_WORLD_VERSION 3\n#define EIGEN_MAJOR_VERSION 3\n#define EIGEN_MINOR_VERSION 9\n")

function(must_refuse way)
  execute_process(
    COMMAND
      "${CMAKE_COMMAND}" -S "${SOURCE}" -B "${BUILD}/${way}" -G "${GENERATOR}"
      "-DCMAKE_CXX_COMPILER=${COMPILER}" -DOPENMP=OFF -DPLIANT_OPENMP=OFF -DPLIANT_CUDA=OFF ${ARGN}
    RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  if(NOT failed OR NOT said MATCHES "needs Eigen3? 3\\.4 or newer, but found 3\\.3\\.9")
    message(FATAL_ERROR "${way}: Eigen 3.3.9 has to be refused by its version. CMake says\n${said}")
  endif()
endfunction()

must_refuse(package "-DPLIANT_SOURCE=${PLIANT_SOURCE}" "-DEigen3_DIR=${old}")
must_refuse(headers "-DPLIANT_SOURCE=${PLIANT_SOURCE}" "-DPLIANT_EIGEN_INCLUDE=${old}")
if(INSTALLED)
  execute_process(COMMAND "${CMAKE_COMMAND}" --install "${PLIANT_BUILD}" --prefix "${BUILD}/prefix"
                          COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
  must_refuse(installed "-DCMAKE_PREFIX_PATH=${BUILD}/prefix" "-DEigen3_DIR=${old}")
endif()
