# cmake -DFOLDER=<of the misuses> -DCOMPILER=<compiler> -DINCLUDE=<folders> -DSAID=<folder to write>
#       -P fail_together.cmake
# Compiles all misuses in one source, each in a namespace of its own, and writes to SAID/<name>.txt the errors in
# code of <name>.cpp with the notes on them: the headers take longer to compile than the misuses. An error of a
# template is said once, of the first of its users. Those with flags of their own are left to
# must_not_compile.cmake.
file(REMOVE_RECURSE "${SAID}")
file(MAKE_DIRECTORY "${SAID}")
set(headers)
set(misuses)
file(GLOB files "${FOLDER}/*.cpp")
foreach(file IN LISTS files)
  file(STRINGS "${file}" flags REGEX "^// flags:")
  if(NOT flags)
    file(STRINGS "${file}" included REGEX "^#include")
    list(APPEND headers ${included})
    get_filename_component(name "${file}" NAME_WE)
    string(APPEND misuses "namespace ${name} {\n#include \"${file}\"\n}\n")
  endif()
endforeach()
list(REMOVE_DUPLICATES headers)
list(JOIN headers "\n" headers)
file(WRITE "${SAID}/all.cpp" "${headers}\n${misuses}")

list(TRANSFORM INCLUDE PREPEND -I)
execute_process(COMMAND "${COMPILER}" -std=c++20 -fsyntax-only -w -fdiagnostics-color=never ${INCLUDE}
                        "${SAID}/all.cpp" OUTPUT_QUIET ERROR_VARIABLE said)

# An error begins behind the last note on the one before it, with the lines that lead to it; notes follow it.
string(FIND "${said}" ": error: " at)
string(SUBSTRING "${said}" 0 ${at} way)
while(NOT at EQUAL -1)
  math(EXPR after "${at} + 9")
  string(SUBSTRING "${said}" ${after} -1 said)
  string(FIND "${said}" ": error: " at)
  string(SUBSTRING "${said}" 0 ${at} message)
  string(FIND "${message}" ": note: " note REVERSE)
  if(note EQUAL -1)
    set(note 0)
  endif()
  string(SUBSTRING "${message}" ${note} -1 last)
  string(FIND "${last}" "\n" end)
  math(EXPR end "${note} + ${end} + 1")
  string(SUBSTRING "${message}" ${end} -1 next_way)
  string(SUBSTRING "${message}" 0 ${end} message)
  string(REGEX MATCHALL "/[a-z0-9_]+\\.cpp:[0-9]" places "${way}")
  list(TRANSFORM places REPLACE "/([a-z0-9_]+)\\.cpp:[0-9]" "\\1")
  list(REMOVE_DUPLICATES places)
  foreach(name IN LISTS places)
    file(APPEND "${SAID}/${name}.txt" "${message}")
  endforeach()
  set(way "${next_way}")
endwhile()
