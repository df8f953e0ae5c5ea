# cradle_layer(NAME [UNITY CONDITION] [APART ...] [LAYERS ...] [LIBRARIES ...]): the folder src/NAME as a static library.
# LAYERS are the folders that it may include (tests/layering_test holds the same table against the includes themselves).
# UNITY, if true: eight files are compiled as one, in half to two thirds of the time, since code from headers is made
# once: names in the folder's files differ. APART: files that are compiled alone, since others use their names.
function(cradle_layer NAME)
  cmake_parse_arguments(ARG "" "UNITY" "APART;LAYERS;LIBRARIES" ${ARGN})
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${NAME}/*.cpp)
  # Of these a program has one: cmake/contexts.cmake, cmake/peers.cmake.
  list(FILTER SOURCES EXCLUDE REGEX "/contexts/|/peers/(bullet|joint_tree|mujoco|no_peers|ode|peer_drives|peer_shapes|peers|simbody)")
  list(TRANSFORM ARG_LAYERS PREPEND cradle_)
  add_library(cradle_${NAME} STATIC ${SOURCES})
  set_target_properties(cradle_${NAME} PROPERTIES UNITY_BUILD "${ARG_UNITY}")
  foreach(SOURCE ${ARG_APART})
    set_source_files_properties(${PROJECT_SOURCE_DIR}/src/${NAME}/${SOURCE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  if(NOT NAME STREQUAL core AND NOT NAME STREQUAL image)  # those do not use Eigen
    target_link_libraries(cradle_${NAME} PUBLIC cradle_headers)
    target_precompile_headers(cradle_${NAME} REUSE_FROM cradle_headers)
  endif()
  target_include_directories(cradle_${NAME} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(cradle_${NAME} PUBLIC ${ARG_LAYERS} ${ARG_LIBRARIES})
endfunction()

# Eigen, fmt and the standard containers, compiled once for all layers: half of the time of a build.
file(WRITE ${PROJECT_BINARY_DIR}/cradle_headers.cpp "")
add_library(cradle_headers STATIC ${PROJECT_BINARY_DIR}/cradle_headers.cpp)
target_link_libraries(cradle_headers PUBLIC Eigen3::Eigen fmt::fmt)
target_precompile_headers(cradle_headers PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <string> <vector> <optional>
  <variant> <algorithm>)
