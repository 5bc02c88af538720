# A project that uses pliant::openmp is told once, at the end of its configuration, what its flags leave
# unused: x86-64 compilers assume no AVX unless they are told.
function(pliant_simd_message)
  get_property(asked GLOBAL PROPERTY pliant_simd_message)
  if(asked OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" OR CMAKE_BUILD_TYPE STREQUAL Debug)
    return()
  endif()
  set_property(GLOBAL PROPERTY pliant_simd_message ON)
  cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL pliant_tell_of_simd)
endfunction()

function(pliant_tell_of_simd)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  pliant_targets_without_simd("${CMAKE_SOURCE_DIR}" "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}"
                              targets)
  if(targets)
    list(GET targets 0 example)
    message(STATUS "pliant::openmp: no flag of ${example} names a processor, so elements are computed "
                   "in SSE registers. -DCMAKE_CXX_FLAGS=-march=native uses those of this processor "
                   "(AVX2 about 0.6 of the time, AVX-512 a third) and makes programs for processors "
                   "like this one; -march=x86-64-v3 is for any with AVX2.")
  endif()
endfunction()

# Targets below a folder that link pliant::openmp themselves and whose flags name no processor.
function(pliant_targets_without_simd folder flags variable)
  set(found "")
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    get_target_property(options ${target} COMPILE_OPTIONS)
    if(libraries MATCHES "pliant(::|_)openmp" AND NOT "${flags} ${options}" MATCHES "-m(arch|avx)")
      list(APPEND found ${target})
    endif()
  endforeach()
  get_property(subfolders DIRECTORY "${folder}" PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    if(NOT subfolder STREQUAL pliant_SOURCE_DIR)
      pliant_targets_without_simd("${subfolder}" "${flags}" more)
      list(APPEND found ${more})
    endif()
  endforeach()
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()
