# Finds a header-only package, or takes its headers from a folder that the user names: for machines
# that have the headers but no package of them.
#
#   pliant_find_headers(<package> TARGET <target> FOLDER <variable> HEADER <header>)
#
# Defines <target>, or leaves it undefined when nothing is found. -D<variable>=<folder> skips the
# search; <folder> has to hold <header>.
function(pliant_find_headers package)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TARGET;FOLDER;HEADER" "")
  if(TARGET ${arg_TARGET})
    return()
  endif()
  if(NOT ${arg_FOLDER})
    find_package(${package} QUIET GLOBAL)
    return()
  endif()
  if(NOT EXISTS "${${arg_FOLDER}}/${arg_HEADER}")
    message(FATAL_ERROR "${arg_FOLDER} is '${${arg_FOLDER}}', which holds no ${arg_HEADER}. "
                        "Point it to the folder above that header.")
  endif()
  add_library(${arg_TARGET} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${arg_TARGET} INTERFACE "${${arg_FOLDER}}")
endfunction()
