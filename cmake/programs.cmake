# How Pliant's own tests, examples and benchmarks are compiled; nothing here reaches its users.
option(PLIANT_NATIVE "Compile tests, examples and benchmarks for this machine's processor"
       ${PROJECT_IS_TOP_LEVEL})
set(PLIANT_SANITIZE "" CACHE STRING "Sanitizers for them, for example address,undefined")

find_program(PLIANT_CCACHE ccache)
if(PLIANT_CCACHE)
  foreach(language IN ITEMS CXX CUDA)
    if(NOT DEFINED CMAKE_${language}_COMPILER_LAUNCHER)
      # What it needs to know precompiled headers by their contents.
      set(CMAKE_${language}_COMPILER_LAUNCHER
          "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "${PLIANT_CCACHE}")
    endif()
  endforeach()
endif()

add_library(pliant_program INTERFACE)
target_compile_options(
  pliant_program
  INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion>"
            "$<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-Wall>")
# g++ 12 takes the undefined operands of its own AVX-512 intrinsics for uninitialised variables, and
# warns of overlaps in its own strings.
target_compile_options(
  pliant_program INTERFACE "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized;-Wno-uninitialized;-Wno-restrict>")
# A collector of garbage that comes late, or never, makes g++ a tenth to a fifth faster, for up to a third more memory.
target_compile_options(
  pliant_program INTERFACE "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=4000000>")
# clang++ gives up tests of tables at compile time early.
target_compile_options(
  pliant_program INTERFACE "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:-fconstexpr-steps=100000000>")
# nvcc warns of calls in Eigen's SparseLU, which only the host makes.
target_compile_options(
  pliant_program INTERFACE "$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:--diag-suppress=20014>")
if(PLIANT_NATIVE)
  # The host side of .cu files too: Eigen aligns its types by the widest vectors, and all files of
  # a program have to agree on them.
  target_compile_options(pliant_program
                         INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-march=native>"
                                   "$<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-march=native>")
endif()
if(PLIANT_SANITIZE)
  target_compile_options(
    pliant_program
    INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${PLIANT_SANITIZE};-fno-sanitize-recover=all>"
              "$<$<COMPILE_LANGUAGE:CXX>:-fno-omit-frame-pointer;-O0;-g1>")
  target_link_options(pliant_program INTERFACE "-fsanitize=${PLIANT_SANITIZE}")
endif()

# Everything that nvcc compiles, to build where there is no GPU to run it on.
if(pliant_has_cuda)
  add_custom_target(pliant_gpu)
  # The device's front end reads host code too, and takes an eighth to a fourth of a whole compilation.
  set(pliant_read_by_nvcc "${CMAKE_CUDA_COMPILER}" -ptx --fdevice-syntax-only -o /dev/null -std=c++20
                          --expt-relaxed-constexpr --diag-suppress=20012)
endif()

# Solvers of matrices, compiled once for all programs of the CPU.
add_library(pliant_program_solvers STATIC EXCLUDE_FROM_ALL "${PROJECT_SOURCE_DIR}/${pliant_solvers_source}")
target_compile_definitions(pliant_program_solvers PUBLIC PLIANT_COMPILED_SOLVERS)
target_link_libraries(pliant_program_solvers PRIVATE pliant_program PUBLIC pliant::pliant)

# pliant_add_program(<target> SOURCES <file>... [CUDA] [LINK <library>...])
# An executable against the library and the backends that this build has; .cu files get
# pliant::cuda alone, since nvcc compiles no SIMD packs.
function(pliant_add_program target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "CUDA" "" "SOURCES;LINK")
  add_executable(${target} ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE pliant_program pliant::pliant ${arg_LINK})
  if(arg_CUDA)
    target_link_libraries(${target} PRIVATE pliant::cuda)
    add_dependencies(pliant_gpu ${target})
  else()
    target_link_libraries(${target} PRIVATE pliant_program_solvers)
    if(pliant_has_openmp)
      target_link_libraries(${target} PRIVATE pliant::openmp)
    endif()
  endif()
endfunction()

# pliant_read_source(<group> <target> <source> <compiler and flags>...)
# Adds to <group> that a compiler's front end reads a source with the folders of a target, again when a header changes.
function(pliant_read_source group target source)
  set(stamp "${CMAKE_CURRENT_BINARY_DIR}/${target}.read")
  add_custom_command(
    OUTPUT "${stamp}"
    # Solvers of matrices are read with the headers. What devices call and only the host can do is an error (20014).
    COMMAND ${ARGN} -DPLIANT_COMPILED_SOLVERS --diag-error=20014
            "-I$<JOIN:$<REMOVE_DUPLICATES:$<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>>,;-I>" -MD -MF "${stamp}.d" -MT
            "${stamp}" "${source}"
    COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}"
    DEPENDS "${source}"
    DEPFILE "${stamp}.d"
    COMMENT "Reading ${target}"
    COMMAND_EXPAND_LISTS VERBATIM)
  add_custom_target(${target}_read DEPENDS "${stamp}")
  add_dependencies(${group} ${target}_read)
endfunction()
