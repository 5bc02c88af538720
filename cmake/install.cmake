# Installs the headers, and a CMake package with a component for each target:
#   find_package(pliant REQUIRED COMPONENTS openmp)
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(package_folder "${CMAKE_INSTALL_DATADIR}/cmake/pliant")

foreach(target IN ITEMS pliant pliant_openmp pliant_cuda)
  install(TARGETS ${target} EXPORT ${target} FILE_SET HEADERS)
  install(EXPORT ${target} NAMESPACE pliant:: DESTINATION "${package_folder}")
endforeach()

configure_package_config_file(cmake/pliantConfig.cmake.in pliantConfig.cmake
                              INSTALL_DESTINATION "${package_folder}" NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break what the one before had.
write_basic_package_version_file(pliantConfigVersion.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/pliantConfig.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/pliantConfigVersion.cmake" cmake/simd_message.cmake
        DESTINATION "${package_folder}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
