# Catch2, version 2 or 3, as the target Catch2::Catch2 whose one header is <catch2/catch.hpp>.
pliant_find_headers(Catch2 TARGET Catch2::Catch2 FOLDER PLIANT_CATCH2_INCLUDE HEADER
                    catch2/catch.hpp MINIMUM 2.13)
if(NOT TARGET Catch2::Catch2)
  message(FATAL_ERROR "The tests need Catch2 2.13 or newer, which was not found. Install it (on "
                      "Debian and Ubuntu: apt-get install catch2), pass -DPLIANT_CATCH2_INCLUDE=<folder "
                      "that holds catch2/catch.hpp>, or do without the tests by "
                      "-DPLIANT_BUILD_TESTS=OFF.")
endif()

# Version 3, a compiled library where 2 is only headers, named its header anew.
get_target_property(catch2_type Catch2::Catch2 TYPE)
if(NOT catch2_type STREQUAL INTERFACE_LIBRARY)
  file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/catch2-3/catch2/catch.hpp"
       CONTENT "#pragma once\n#include <catch2/catch_all.hpp>\n")
  target_include_directories(Catch2::Catch2 SYSTEM INTERFACE "${CMAKE_CURRENT_BINARY_DIR}/catch2-3")
endif()
