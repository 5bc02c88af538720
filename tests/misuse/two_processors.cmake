# cmake -DCOMPILER=<compiler> -DINCLUDE=<folders> -DBUILD=<folder> -P two_processors.cmake
# A program with sources for registers of two widths has to say so, where solvers begin.
file(MAKE_DIRECTORY "${BUILD}")
file(WRITE "${BUILD}/other.cpp" "#include <pliant/solver/linear/same_registers.hpp>\n")
file(
  WRITE "${BUILD}/main.cpp"
  [=[
#include <iostream>

#include <pliant/solver/linear/same_registers.hpp>

int main() {
  try {
    pliant::detail::check_registers();
    std::cout << "nothing is wrong";
  } catch (pliant::Error const& error) {
    std::cout << error.what();
  }
}
]=])
list(TRANSFORM INCLUDE PREPEND -I)
function(run march expected)
  execute_process(COMMAND "${COMPILER}" -std=c++20 ${INCLUDE} -march=x86-64-v3 -c "${BUILD}/other.cpp" -o
                          "${BUILD}/other.o" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${COMPILER}" -std=c++20 ${INCLUDE} -march=${march} "${BUILD}/main.cpp" "${BUILD}/other.o"
                          -o "${BUILD}/program" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${BUILD}/program" OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
  if(NOT said MATCHES "${expected}")
    message(FATAL_ERROR "Sources for x86-64-v3 beside one for ${march} say\n${said}\nand not '${expected}'")
  endif()
endfunction()
run(x86-64-v3 "nothing is wrong")
run(x86-64 "the same -march")
