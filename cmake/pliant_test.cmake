# pliant_test(NAME <area>/<name> SOURCES <file>... [OPENMP | CUDA] [LINK <library>...]
#             [DEFINE <definition>...] [TESTS <file>...])
# One program and one test, labelled with its area; or a test for each of the files TESTS, which the sources
# include. OPENMP and CUDA mark tests that need this backend; they are left out where it is missing. The
# others get every CPU backend that this build has: the serial one always, <pliant/openmp.hpp> where
# _OPENMP is defined. The target pliant_tests builds all of them, and nothing else.
add_custom_target(pliant_tests)
function(pliant_test)
  cmake_parse_arguments(PARSE_ARGV 0 arg "OPENMP;CUDA" "NAME" "SOURCES;LINK;DEFINE;TESTS")
  if((arg_OPENMP AND NOT pliant_has_openmp) OR (arg_CUDA AND NOT pliant_has_cuda))
    return()
  endif()
  string(MAKE_C_IDENTIFIER "test_${arg_NAME}" target)

  if(arg_CUDA)
    pliant_add_program(${target} CUDA SOURCES ${arg_SOURCES} LINK pliant_gpu_test_main ${arg_LINK})
    set(label gpu)
    set(suffix _gpu)
  else()
    pliant_add_program(${target} SOURCES ${arg_SOURCES} LINK pliant_test_main ${arg_LINK})
    set(label)
    set(suffix)
  endif()

  target_compile_definitions(${target} PRIVATE ${arg_DEFINE})
  # Most tests take longer to optimise than to run. What the optimiser makes of kernels is looked at by
  # those that compare backends, on one law for each linear element.
  set(level -O0)
  if(arg_NAME MATCHES "^(adaptation/(marking|sleep)|openmp/threads|solver/local_steps)$")
    set(level -O1)
  elseif(arg_NAME MATCHES "^(backend|openmp)/" AND NOT arg_NAME MATCHES "^backend/agreement_")
    set(level -O3)
  endif()
  if(NOT arg_CUDA)
    pliant_precompile(${target} ${level})
  endif()
  # It looks at what builds with NDEBUG, as that of the precompiled headers is, leave out.
  if(arg_NAME STREQUAL "backend/field_bounds")
    set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  endif()
  add_dependencies(pliant_tests ${target})

  if(arg_TESTS)
    foreach(file IN LISTS arg_TESTS)
      string(REGEX REPLACE "_[a-z]+\\.[a-z]+$" "" name "${file}")
      get_filename_component(tag "${file}" NAME_WE)
      pliant_add_test(${name}${suffix} "${label}" ${target} --filenames-as-tags "[#${tag}]")
    endforeach()
  else()
    pliant_add_test(${arg_NAME} "${label}" ${target})
  endif()
endfunction()

# pliant_add_test(<area>/<name> <label> <command>...)
function(pliant_add_test name label)
  add_test(NAME ${name} COMMAND ${ARGN})
  get_filename_component(area "${name}" DIRECTORY)
  set(leak_options "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp")
  # Tests run side by side: threads that wait must not keep the cores from those that work.
  set_tests_properties(
    ${name} PROPERTIES LABELS "${area};${label}" TIMEOUT 600 SKIP_RETURN_CODE 77
                       FAIL_REGULAR_EXPRESSION "No test cases matched"
                       ENVIRONMENT "OMP_WAIT_POLICY=PASSIVE;${leak_options}")
endfunction()
