# cmake -DCOMPILER=<compiler> -DINCLUDE=<folders> -DBUILD=<folder> -P must_not_link.cmake
# A program one source of which is compiled for other registers than its compiled solvers are: what Eigen allocates in
# one, the other would free another way.
file(MAKE_DIRECTORY "${BUILD}")
file(WRITE "${BUILD}/solvers.cpp" "#include <pliant/solver/linear/definitions/compiled_solvers.hpp>\n")
file(WRITE "${BUILD}/main.cpp" "#include <pliant/solver/linear/compiled_once.hpp>\nint main() {}\n")
list(TRANSFORM INCLUDE PREPEND -I)
function(build march)
  set(command "${COMPILER}" -std=c++20 -DPLIANT_COMPILED_SOLVERS ${INCLUDE})
  execute_process(COMMAND ${command} -march=x86-64-v3 -c "${BUILD}/solvers.cpp" -o "${BUILD}/solvers.o"
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${command} -march=${march} -c "${BUILD}/main.cpp" -o "${BUILD}/main.o"
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${COMPILER}" "${BUILD}/main.o" "${BUILD}/solvers.o" -o "${BUILD}/program"
                  RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  set(failed "${failed}" PARENT_SCOPE)
  set(said "${said}" PARENT_SCOPE)
endfunction()
build(x86-64-v3)
if(failed)
  message(FATAL_ERROR "A program of sources for one processor does not link:\n${said}")
endif()
build(x86-64)
if(NOT failed OR NOT said MATCHES "need_the_same_march_in_all_sources")
  message(FATAL_ERROR "A program of sources for two processors links, or its linker does not say why not:\n${said}")
endif()
