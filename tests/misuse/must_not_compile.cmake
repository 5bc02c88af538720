# cmake -DSOURCE=<file> -DCOMPILER=<compiler> -DINCLUDE=<folders> -DSAID=<folder that fail_together.cmake wrote>
#       -P must_not_compile.cmake
file(STRINGS "${SOURCE}" first_line LIMIT_COUNT 1)
if(NOT first_line MATCHES "^// expect: (.+)$")
  message(FATAL_ERROR "${SOURCE} has to begin with a line '// expect: <regular expression>'")
endif()
set(expected "${CMAKE_MATCH_1}")

# What the compiler said of it among the others will do.
get_filename_component(name "${SOURCE}" NAME_WE)
if(EXISTS "${SAID}/${name}.txt")
  file(READ "${SAID}/${name}.txt" said)
  if(said MATCHES "${expected}")
    return()
  endif()
endif()

# With flags of its own it is compiled to assembly: some diagnostics come only then.
set(mode -fsyntax-only)
file(STRINGS "${SOURCE}" flags LIMIT_COUNT 1 REGEX "^// flags: ")
if(flags)
  string(REPLACE "// flags: " "" flags "${flags}")
  separate_arguments(mode UNIX_COMMAND "${flags} -S -o /dev/null")
endif()

list(TRANSFORM INCLUDE PREPEND -I)
set(command "${COMPILER}" -std=c++20 ${mode} ${INCLUDE} "${SOURCE}")

execute_process(COMMAND ${command} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT failed)
  message(FATAL_ERROR "${SOURCE} compiles, but must not")
endif()
if(NOT said MATCHES "${expected}")
  message(FATAL_ERROR "The compiler refuses ${SOURCE}, but does not say\n  ${expected}\nIt says\n${said}")
endif()

# The rest of the others is compiled together, by rest_must_compile.cmake.
file(STRINGS "${SOURCE}" flags REGEX "^// flags:")
file(STRINGS "${SOURCE}" switch REGEX "PLIANT_MISUSE_OFF")
if(flags AND switch)
  execute_process(COMMAND ${command} -DPLIANT_MISUSE_OFF RESULT_VARIABLE failed OUTPUT_VARIABLE said
                  ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "Without its misuse ${SOURCE} has to compile. The compiler says\n${said}")
  endif()
endif()
