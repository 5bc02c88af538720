# pliant_test(NAME <area>/<name> SOURCES <file>... [OPENMP | CUDA] [LINK <library>...]
#             [DEFINE <definition>...])
# One program and one test, labelled with its area. OPENMP and CUDA mark tests that need this
# backend; they are left out where it is missing. The others get every CPU backend that this build
# has: the serial one always, <pliant/openmp.hpp> where _OPENMP is defined. The target pliant_tests builds
# all of them, and nothing else.
add_custom_target(pliant_tests)
function(pliant_test)
  cmake_parse_arguments(PARSE_ARGV 0 arg "OPENMP;CUDA" "NAME" "SOURCES;LINK;DEFINE")
  if((arg_OPENMP AND NOT pliant_has_openmp) OR (arg_CUDA AND NOT pliant_has_cuda))
    return()
  endif()
  string(MAKE_C_IDENTIFIER "test_${arg_NAME}" target)
  string(REGEX REPLACE "/.*" "" labels "${arg_NAME}")

  if(arg_CUDA)
    list(APPEND labels gpu)
    pliant_add_program(${target} CUDA SOURCES ${arg_SOURCES} LINK pliant_gpu_test_main ${arg_LINK})
  else()
    pliant_add_program(${target} SOURCES ${arg_SOURCES} LINK pliant_test_main ${arg_LINK})
  endif()

  target_compile_definitions(${target} PRIVATE ${arg_DEFINE})
  # Most tests take longer to optimise than to run. What the optimiser makes of kernels is looked at by
  # those that compare backends, thoroughly for the linear elements.
  set(level -O0)
  if(arg_NAME MATCHES "^(adaptation/(marking|endurance|sleep)|solver/(linear|local_steps))$")
    set(level -O1)
  elseif(arg_NAME MATCHES "^(backend|openmp)/" AND NOT arg_NAME MATCHES "^backend/agreement_")
    set(level -O3)
  endif()
  target_compile_options(${target}
                         PRIVATE $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Release>>:${level}>)

  set(leak_options "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp")
  add_dependencies(pliant_tests ${target})
  add_test(NAME ${arg_NAME} COMMAND ${target})
  # Tests run side by side: threads that wait must not keep the cores from those that work.
  set_tests_properties(
    ${arg_NAME} PROPERTIES LABELS "${labels}" TIMEOUT 600 SKIP_RETURN_CODE 77
                           ENVIRONMENT "OMP_WAIT_POLICY=PASSIVE;${leak_options}")
endfunction()
