# cradle_link_context(TARGET [osmesa|egl]): gives a program that draws its OpenGL context; by default that of the option
# CRADLE_EGL.
function(cradle_link_context TARGET)
  set(KIND ${ARGN})
  if(NOT KIND AND CRADLE_EGL)
    set(KIND egl)
  elseif(NOT KIND)
    set(KIND osmesa)
  endif()
  set(CONTEXT ${PROJECT_SOURCE_DIR}/src/render/contexts/${KIND}_context.cpp)
  target_sources(${TARGET} PRIVATE ${CONTEXT})
  set_source_files_properties(${CONTEXT} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # another program may leave it out
  if(KIND STREQUAL egl)
    target_link_libraries(${TARGET} PRIVATE ${EGL})
  else()
    target_link_libraries(${TARGET} PRIVATE ${CMAKE_DL_LIBS})  # it opens OSMesa itself
  endif()
endfunction()
