# Finds CHOLMOD as SuiteSparse::CHOLMOD, which is what SuiteSparse calls it itself from version 7 on.
if(NOT TARGET SuiteSparse::CHOLMOD)
  find_package(CHOLMOD CONFIG QUIET)
endif()
if(NOT TARGET SuiteSparse::CHOLMOD)
  find_path(PLIANT_CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse)
  find_library(PLIANT_CHOLMOD_LIBRARY cholmod)
  mark_as_advanced(PLIANT_CHOLMOD_INCLUDE PLIANT_CHOLMOD_LIBRARY)
  if(PLIANT_CHOLMOD_INCLUDE AND PLIANT_CHOLMOD_LIBRARY)
    add_library(SuiteSparse::CHOLMOD UNKNOWN IMPORTED)
    set_target_properties(
      SuiteSparse::CHOLMOD PROPERTIES IMPORTED_LOCATION "${PLIANT_CHOLMOD_LIBRARY}"
                                      INTERFACE_INCLUDE_DIRECTORIES "${PLIANT_CHOLMOD_INCLUDE}")
  endif()
endif()
