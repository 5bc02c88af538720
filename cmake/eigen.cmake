# Eigen, the only dependency of pliant::pliant.
pliant_find_headers(Eigen3 TARGET Eigen3::Eigen FOLDER PLIANT_EIGEN_INCLUDE HEADER Eigen/Core)
if(NOT TARGET Eigen3::Eigen)
  message(FATAL_ERROR "Pliant needs Eigen 3.4 or newer, which was not found. Install it (on "
                      "Debian and Ubuntu: apt-get install libeigen3-dev), or pass -DEigen3_DIR=<folder of "
                      "Eigen3Config.cmake> or -DPLIANT_EIGEN_INCLUDE=<folder that holds "
                      "Eigen/Core>.")
endif()
