# cradle_layer(NAME [LAYERS ...] [LIBRARIES ...]): the folder src/NAME as a static library. LAYERS are the
# folders that it may include (tests/layering_test holds the same table against the includes themselves).
function(cradle_layer NAME)
  cmake_parse_arguments(ARG "" "" "LAYERS;LIBRARIES" ${ARGN})
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${NAME}/*.cpp)
  list(TRANSFORM ARG_LAYERS PREPEND cradle_)
  add_library(cradle_${NAME} STATIC ${SOURCES})
  target_include_directories(cradle_${NAME} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(cradle_${NAME} PUBLIC ${ARG_LAYERS} ${ARG_LIBRARIES})
endfunction()
