# The targets, header-only all of them:
#   pliant::pliant   the library and its serial Reference backend; needs Eigen and the system's threads
#   pliant::openmp   with the OpenMP backend
#   pliant::cuda     with the CUDA backend
#   pliant::solvers  beside one of these, for programs that take long to compile: the solvers of matrices that solve.hpp
#                    rests on are one more source of the program, instead of a part of each
#   pliant::cholmod  beside one of these, in all sources of a program: large symmetric matrices are factorised by
#                    SuiteSparse's CHOLMOD (its supernodal part is under the GPL)
# Those of OpenMP, CUDA and CHOLMOD exist under these names only where this build has what they need. They are
# installed all the same: an installed copy looks for them when a project asks for them.

# pliant_add_headers(<target> <include root>...): an interface library of all headers there.
function(pliant_add_headers target)
  list(TRANSFORM ARGN PREPEND "${PROJECT_SOURCE_DIR}/" OUTPUT_VARIABLE roots)
  foreach(root IN LISTS roots)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS "${root}/*.hpp" "${root}/*.cuh")
    list(APPEND headers ${found})
  endforeach()
  add_library(${target} INTERFACE)
  target_sources(${target} INTERFACE FILE_SET HEADERS BASE_DIRS ${roots} FILES ${headers})
endfunction()

pliant_add_headers(pliant include backends/reference)
add_library(pliant::pliant ALIAS pliant)
target_compile_features(pliant INTERFACE cxx_std_20)
find_package(Threads REQUIRED)
target_link_libraries(pliant INTERFACE Eigen3::Eigen Threads::Threads)

add_library(pliant_solvers INTERFACE)
add_library(pliant::solvers ALIAS pliant_solvers)
set_target_properties(pliant_solvers PROPERTIES EXPORT_NAME solvers)
set(pliant_solvers_source include/pliant/solver/compiled.cpp)
target_sources(
  pliant_solvers INTERFACE "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/${pliant_solvers_source}>"
                           "$<INSTALL_INTERFACE:${pliant_solvers_source}>")
target_compile_definitions(pliant_solvers INTERFACE PLIANT_COMPILED_SOLVERS)
target_link_libraries(pliant_solvers INTERFACE pliant)

add_library(pliant_cholmod INTERFACE)
set_target_properties(pliant_cholmod PROPERTIES EXPORT_NAME cholmod)
target_compile_definitions(pliant_cholmod INTERFACE PLIANT_CHOLMOD)
target_link_libraries(pliant_cholmod INTERFACE pliant SuiteSparse::CHOLMOD)
if(pliant_has_cholmod)
  add_library(pliant::cholmod ALIAS pliant_cholmod)
endif()

pliant_add_headers(pliant_openmp backends/openmp)
set_target_properties(pliant_openmp PROPERTIES EXPORT_NAME openmp)
target_link_libraries(pliant_openmp INTERFACE pliant OpenMP::OpenMP_CXX)
# Projects are told of AVX when they are configured, not by each compilation.
target_compile_definitions(pliant_openmp INTERFACE PLIANT_WITHOUT_AVX)
if(NOT PROJECT_IS_TOP_LEVEL)
  include("${CMAKE_CURRENT_LIST_DIR}/simd_message.cmake")
  pliant_simd_message()
endif()
# g++ 12 crashes in this pass on the largest kernels of packs; packs are vectors already and gain
# nothing from it.
target_compile_options(
  pliant_openmp
  INTERFACE
    "$<$<AND:$<COMPILE_LANG_AND_ID:CXX,GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-fno-tree-slp-vectorize>"
)
if(pliant_has_openmp)
  add_library(pliant::openmp ALIAS pliant_openmp)
endif()

pliant_add_headers(pliant_cuda backends/cuda)
set_target_properties(pliant_cuda PROPERTIES EXPORT_NAME cuda)
target_link_libraries(pliant_cuda INTERFACE pliant CUDA::cudart)
# The standard as an option, since CMake knows C++20 for nvcc from 3.26 on only. Kernels call
# constexpr functions of the standard library; Eigen and the defaulted members of types for host and
# device set off warning 20012, which tells of markers that nvcc ignores.
target_compile_options(
  pliant_cuda
  INTERFACE
    "$<$<COMPILE_LANGUAGE:CUDA>:-std=c++20>"
    "$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:--expt-relaxed-constexpr;--diag-suppress=20012>")
if(pliant_has_cuda)
  add_library(pliant::cuda ALIAS pliant_cuda)
endif()
