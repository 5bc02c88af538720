# cmake -DFOLDER=<of the misuses> -DCOMPILER=<compiler> -DINCLUDE=<folders> -DSOURCE=<to write>
#       -P rest_must_compile.cmake
# Every misuse has to compile without what is wrong in it. All are included in one source, each in a
# namespace of its own, after the headers of all. Those with flags of their own are left to
# must_not_compile.cmake.
set(headers)
set(rests)
file(GLOB misuses "${FOLDER}/*.cpp")
foreach(misuse IN LISTS misuses)
  file(STRINGS "${misuse}" flags REGEX "^// flags:")
  file(STRINGS "${misuse}" switch REGEX "PLIANT_MISUSE_OFF")
  if(switch AND NOT flags)
    file(STRINGS "${misuse}" included REGEX "^#include")
    list(APPEND headers ${included})
    get_filename_component(name "${misuse}" NAME_WE)
    string(APPEND rests "namespace ${name} {\n#include \"${misuse}\"\n}\n")
  endif()
endforeach()
list(REMOVE_DUPLICATES headers)
list(JOIN headers "\n" headers)
file(WRITE "${SOURCE}" "#define PLIANT_MISUSE_OFF\n${headers}\n${rests}")

list(TRANSFORM INCLUDE PREPEND -I)
# main() in a namespace is a function as any other, and warned of for returning nothing.
execute_process(COMMAND "${COMPILER}" -std=c++20 -fsyntax-only -w ${INCLUDE} "${SOURCE}"
                RESULT_VARIABLE failed ERROR_VARIABLE said)
if(failed)
  message(FATAL_ERROR "Without its misuse each file has to compile. The compiler says\n${said}")
endif()
