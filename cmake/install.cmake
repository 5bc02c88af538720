# Installs the headers, and a CMake package with a component for each target:
#   find_package(pliant REQUIRED COMPONENTS openmp)
#
# A project that exports targets which link Pliant's needs these exports to exist, whether or not it
# installs Pliant too: without PLIANT_INSTALL the rules are there, and no installation follows them.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(package_folder "${CMAKE_INSTALL_DATADIR}/cmake/pliant")
set(rule COMPONENT pliant)
if(NOT PLIANT_INSTALL)
  list(APPEND rule EXCLUDE_FROM_ALL)
endif()

foreach(target IN ITEMS pliant pliant_solvers pliant_cholmod pliant_openmp pliant_cuda)
  if(target MATCHES "solvers|cholmod")
    install(TARGETS ${target} EXPORT ${target} ${rule})
  else()
    install(TARGETS ${target} EXPORT ${target} FILE_SET HEADERS ${rule})
  endif()
  install(EXPORT ${target} NAMESPACE pliant:: DESTINATION "${package_folder}" ${rule})
  export(EXPORT ${target} NAMESPACE pliant:: FILE "${PROJECT_BINARY_DIR}/exports/${target}.cmake")
endforeach()

# Where its target looks for it, which CMAKE_INSTALL_INCLUDEDIR does not move.
install(FILES "${PROJECT_SOURCE_DIR}/${pliant_solvers_source}" DESTINATION include/pliant/solver
        ${rule})

configure_package_config_file(cmake/pliantConfig.cmake.in pliantConfig.cmake
                              INSTALL_DESTINATION "${package_folder}" NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break what the one before had.
write_basic_package_version_file(pliantConfigVersion.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/pliantConfig.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/pliantConfigVersion.cmake" cmake/simd_message.cmake
              cmake/find_cholmod.cmake
        DESTINATION "${package_folder}" ${rule})
# The folder of documents that a project above has set is for its own licence.
if(PROJECT_IS_TOP_LEVEL)
  set(document_folder "${CMAKE_INSTALL_DOCDIR}")
else()
  set(document_folder "${CMAKE_INSTALL_DATAROOTDIR}/doc/pliant")
endif()
install(FILES LICENSE DESTINATION "${document_folder}" ${rule})
