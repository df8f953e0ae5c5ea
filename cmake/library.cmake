# The libraries that other programs link, each as one archive: Cradle::simulate, and Cradle::render on top of it.
include(CMakePackageConfigHelpers)

# cradle_archive(NAME SOURCES ... LAYERS ...): what include/cradle promises, with the layers behind it.
function(cradle_archive NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LAYERS" ${ARGN})
  list(TRANSFORM ARG_LAYERS PREPEND cradle_)
  add_library(library_${NAME}_objects OBJECT ${ARG_SOURCES})
  target_include_directories(library_${NAME}_objects PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(library_${NAME}_objects PRIVATE ${ARG_LAYERS})
  target_precompile_headers(library_${NAME}_objects REUSE_FROM cradle_headers)
  set_target_properties(library_${NAME}_objects PROPERTIES UNITY_BUILD ON)
  set(OBJECTS $<TARGET_OBJECTS:library_${NAME}_objects>)
  foreach(LAYER ${ARG_LAYERS})
    list(APPEND OBJECTS $<TARGET_OBJECTS:${LAYER}>)
  endforeach()
  add_library(library_${NAME} STATIC ${OBJECTS})
  set_target_properties(library_${NAME} PROPERTIES OUTPUT_NAME cradle_${NAME} EXPORT_NAME ${NAME} LINKER_LANGUAGE CXX
    ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/library)
  target_compile_features(library_${NAME} INTERFACE cxx_std_20)
  target_include_directories(library_${NAME} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endfunction()

cradle_archive(simulate SOURCES library/scene.cpp library/trajectory.cpp library/simulate.cpp library/watch.cpp
  LAYERS core math mesh scene dynamics constraints collision impact trajectory simulate)
target_link_libraries(library_simulate PRIVATE fmt::fmt assimp::assimp Qhull::qhull_r SQLite::SQLite3 seccomp Threads::Threads)

cradle_archive(render SOURCES library/render.cpp library/drawing_thread.cpp LAYERS image render overlay film player)
target_link_libraries(library_render PUBLIC library_simulate PRIVATE PNG::PNG deflate ${CMAKE_DL_LIBS})
cradle_link_context(library_render)
target_include_directories(library_render PRIVATE ${PROJECT_SOURCE_DIR}/src)
# A program with a window has functions of OpenGL by the names of ours, which stand in for them where there is no screen,
# and may have a GLEW of its own: with GLEW inside, and those names kept inside, both go their ways.
add_custom_command(TARGET library_render POST_BUILD
  COMMAND ${CMAKE_LINKER} -r -o cradle_render.o --whole-archive $<TARGET_FILE:library_render> ${GLEW}
  COMMAND ${CMAKE_OBJCOPY} --wildcard --localize-symbol=gl* --localize-symbol=__gl* --localize-symbol=__GL*
    --localize-symbol=_gl* --localize-symbol=cradleNoDisplay cradle_render.o
  COMMAND ${CMAKE_COMMAND} -E rm $<TARGET_FILE:library_render>
  COMMAND ${CMAKE_AR} qcs $<TARGET_FILE:library_render> cradle_render.o
  COMMAND ${CMAKE_COMMAND} -E rm cradle_render.o
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/library VERBATIM)

set(CRADLE_CONFIG_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/Cradle)
install(TARGETS library_simulate library_render EXPORT CradleTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT CradleTargets NAMESPACE Cradle:: DESTINATION ${CRADLE_CONFIG_FOLDER})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/cradle DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/library/CradleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/CradleConfig.cmake ${PROJECT_BINARY_DIR}/library/CradleConfigVersion.cmake
  DESTINATION ${CRADLE_CONFIG_FOLDER})
