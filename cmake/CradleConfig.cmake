# find_package(Cradle): the targets Cradle::simulate and Cradle::render.
include(CMakeFindDependencyMacro)
foreach(PACKAGE Threads fmt assimp Qhull SQLite3 PNG)
  find_dependency(${PACKAGE})
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/CradleTargets.cmake)
