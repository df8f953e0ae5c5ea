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
    set(LIBRARIES ${EGL} ${OPENGL})
  else()
    set(LIBRARIES ${OSMESA})
  endif()
  # They stand before the layers that use them: the linker must keep them until then.
  target_link_libraries(${TARGET} PRIVATE -Wl,--push-state,--no-as-needed ${LIBRARIES} -Wl,--pop-state)
endfunction()
