include(CMakeFindDependencyMacro)
find_dependency(pliant)
include("${CMAKE_CURRENT_LIST_DIR}/host.cmake")
