# Eigen, the only dependency of pliant::pliant.
set(pliant_eigen_minimum 3.4)

if(PLIANT_EIGEN_INCLUDE)
  # Versions 5 and later number WORLD.MAJOR.MINOR on from 3.5, and say so in a header of its own.
  foreach(header IN ITEMS Eigen/src/Core/util/Macros.h Eigen/Version)
    if(EXISTS "${PLIANT_EIGEN_INCLUDE}/${header}")
      file(STRINGS "${PLIANT_EIGEN_INCLUDE}/${header}" lines
           REGEX "define EIGEN_(WORLD|MAJOR|MINOR)_VERSION [0-9]+")
      string(REGEX MATCHALL "[0-9]+" numbers "${lines}")
      if(numbers)
        list(JOIN numbers "." Eigen3_VERSION)
      endif()
    endif()
  endforeach()
endif()

pliant_find_headers(Eigen3 TARGET Eigen3::Eigen FOLDER PLIANT_EIGEN_INCLUDE HEADER Eigen/Core MINIMUM
                    ${pliant_eigen_minimum})
if(NOT TARGET Eigen3::Eigen)
  message(FATAL_ERROR "Pliant needs Eigen ${pliant_eigen_minimum} or newer, which was not found. "
                      "Install it (on Debian and Ubuntu: apt-get install libeigen3-dev), or pass "
                      "-DEigen3_DIR=<folder of Eigen3Config.cmake> or "
                      "-DPLIANT_EIGEN_INCLUDE=<folder that holds Eigen/Core>.")
endif()
