# Builds and runs the project in SOURCE, which gets Pliant in the WAY that CMakeLists.txt beside this
# file passes with the other variables.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}\nfailed:\n${said}")
  endif()
endfunction()

file(REMOVE_RECURSE "${BUILD}")
if(WAY STREQUAL find_package)
  run("${CMAKE_COMMAND}" --install "${PLIANT_BUILD}" --prefix "${BUILD}/prefix")
  set(arguments "-DCMAKE_PREFIX_PATH=${BUILD}/prefix" "-DEigen3_DIR=${Eigen3_DIR}")
else()
  set(arguments "-DPLIANT_SOURCE=${PLIANT_SOURCE}" "-DPLIANT_OPENMP=${OPENMP}" -DPLIANT_CUDA=OFF
                "-DPLIANT_EIGEN_INCLUDE=${PLIANT_EIGEN_INCLUDE}" "-DEigen3_DIR=${Eigen3_DIR}")
endif()
run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${BUILD}/build" -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" -DOPENMP=${OPENMP} ${arguments})
run("${CMAKE_COMMAND}" --build "${BUILD}/build")
run("${BUILD}/build/serial")
if(OPENMP)
  run("${BUILD}/build/parallel")
endif()
