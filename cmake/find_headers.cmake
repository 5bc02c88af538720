# Finds a header-only package, or takes its headers from a folder that the user names: for machines
# that have the headers but no package of them.
#
#   pliant_find_headers(<package> TARGET <target> FOLDER <variable> HEADER <header>
#                       [MINIMUM <version>])
#
# Defines <target>, or leaves it undefined when nothing is found. -D<variable>=<folder> skips the
# search; <folder> has to hold <header>. A version below the minimum is an error, where the version is
# known: of a package, and of headers or a target that are there already when <package>_VERSION says it.
function(pliant_find_headers package)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TARGET;FOLDER;HEADER;MINIMUM" "")
  set(from "Its target ${arg_TARGET} is one of this project.")
  if(NOT TARGET ${arg_TARGET} AND ${arg_FOLDER})
    if(NOT EXISTS "${${arg_FOLDER}}/${arg_HEADER}")
      message(FATAL_ERROR "${arg_FOLDER} is '${${arg_FOLDER}}', which holds no ${arg_HEADER}. "
                          "Point it to the folder above that header.")
    endif()
    add_library(${arg_TARGET} INTERFACE IMPORTED GLOBAL)
    target_include_directories(${arg_TARGET} INTERFACE "${${arg_FOLDER}}")
    set(from "It is in ${arg_FOLDER}, '${${arg_FOLDER}}'.")
  elseif(NOT TARGET ${arg_TARGET})
    # The version is compared below, since packages of a later major version call themselves
    # incompatible with the minimum.
    find_package(${package} QUIET GLOBAL)
    set(from "It is in ${package}_DIR, '${${package}_DIR}'.")
  endif()
  if(TARGET ${arg_TARGET}
     AND arg_MINIMUM
     AND DEFINED ${package}_VERSION
     AND ${package}_VERSION VERSION_LESS arg_MINIMUM)
    message(FATAL_ERROR "Pliant needs ${package} ${arg_MINIMUM} or newer, but found "
                        "${${package}_VERSION}. ${from} Point -D${package}_DIR or -D${arg_FOLDER} to "
                        "a newer one.")
  endif()
endfunction()
