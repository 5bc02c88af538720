# Turns PLIANT_CHOLMOD into pliant_has_cholmod.
set(pliant_has_cholmod OFF)
if(PLIANT_CHOLMOD)
  include("${CMAKE_CURRENT_LIST_DIR}/find_cholmod.cmake")
  if(TARGET SuiteSparse::CHOLMOD)
    set(pliant_has_cholmod ON)
  elseif(NOT PLIANT_CHOLMOD STREQUAL AUTO)
    message(FATAL_ERROR "PLIANT_CHOLMOD is ${PLIANT_CHOLMOD}, but CHOLMOD was not found. Install SuiteSparse "
                        "(Debian and Ubuntu: apt-get install libsuitesparse-dev libopenblas-dev).")
  endif()
endif()
