# cradle_layer(NAME [READS] [APART ...] [LAYERS ...] [LIBRARIES ...]): the folder src/NAME as a static library.
# LAYERS are the folders that it may include (tests/layering_test holds the same table against the includes themselves).
# Eight files are compiled as one, in half to two thirds of the time, since code from headers is made once: names in the
# folder's files differ. APART: files that are compiled alone, since others use their names. READS: a layer that reads,
# prints and leaves computing to others is optimised less, in two thirds of the compile time.
function(cradle_layer NAME)
  cmake_parse_arguments(ARG "READS" "" "APART;LAYERS;LIBRARIES" ${ARGN})
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${NAME}/*.cpp)
  # Of these a program has one: cmake/contexts.cmake, cmake/peers.cmake.
  list(FILTER SOURCES EXCLUDE REGEX "/contexts/|/peers/(bullet|joint_tree|mujoco|no_peers|ode|peer_drives|peer_shapes|peers|simbody)")
  list(TRANSFORM ARG_LAYERS PREPEND cradle_)
  add_library(cradle_${NAME} STATIC ${SOURCES})
  set_target_properties(cradle_${NAME} PROPERTIES UNITY_BUILD ON)
  foreach(SOURCE ${ARG_APART})
    set_source_files_properties(${PROJECT_SOURCE_DIR}/src/${NAME}/${SOURCE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  if(NOT NAME STREQUAL core AND NOT NAME STREQUAL image)  # those do not use Eigen
    target_link_libraries(cradle_${NAME} PUBLIC cradle_headers)
    set(HEADERS cradle_headers)
    if(ARG_READS)
      set(HEADERS cradle_reading_headers)
      target_compile_options(cradle_${NAME} PRIVATE ${READING_OPTIONS})
    endif()
    target_precompile_headers(cradle_${NAME} REUSE_FROM ${HEADERS})
  endif()
  target_include_directories(cradle_${NAME} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(cradle_${NAME} PUBLIC ${ARG_LAYERS} ${ARG_LIBRARIES})
endfunction()

# cradle_precompiled(NAME OPTIONS ...): Eigen, fmt and the standard containers, compiled once for all layers that have the
# same options: half of the time of a build.
function(cradle_precompiled NAME)
  file(WRITE ${PROJECT_BINARY_DIR}/${NAME}.cpp "")
  add_library(${NAME} STATIC ${PROJECT_BINARY_DIR}/${NAME}.cpp)
  target_link_libraries(${NAME} PUBLIC Eigen3::Eigen fmt::fmt)
  target_compile_options(${NAME} PRIVATE ${ARGN})
  target_precompile_headers(${NAME} PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <string> <vector> <optional>
    <variant> <algorithm>)
endfunction()
cradle_precompiled(cradle_headers)

# -O1 brings another false alarm of g++ 12 inside std::string. Under sanitizers, checks of addresses are calls.
set(READING_OPTIONS $<$<CONFIG:Release>:-O1> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
if(CRADLE_SANITIZE)
  list(APPEND READING_OPTIONS "$<$<CXX_COMPILER_ID:Clang>:SHELL:-mllvm -asan-instrumentation-with-call-threshold=0>")
endif()
cradle_precompiled(cradle_reading_headers ${READING_OPTIONS})

# cradle_link_first(TARGET VISIBILITY LAYERS ...): a program has all of these layers, and that they use, before all else.
# Layers have inline functions of Eigen's in common, of which the linker takes the first: less optimised ones would make
# the layers that compute run up to twenty times as long.
function(cradle_link_first TARGET VISIBILITY)
  set(LAYERS ${ARGN})
  foreach(LAYER ${ARGN})
    get_target_property(USED ${LAYER} LINK_LIBRARIES)
    list(FILTER USED INCLUDE REGEX "^cradle_")
    list(APPEND LAYERS ${USED})
  endforeach()
  list(REMOVE_DUPLICATES LAYERS)
  list(TRANSFORM LAYERS REPLACE "(.+)" "$<TARGET_FILE:\\1>")
  target_link_options(${TARGET} ${VISIBILITY} LINKER:--whole-archive ${LAYERS} LINKER:--no-whole-archive)
endfunction()
