# As a script (cmake -DOUTPUT=... -DFOLDER=... -P): writes a C++ source that holds every file of the shader folder.
# Included: cradle_embed_shaders(TARGET) adds that source to a target, made anew when a shader changes.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB SHADERS ${FOLDER}/*.glsl ${FOLDER}/*.vert ${FOLDER}/*.frag)
  list(SORT SHADERS)
  set(ENTRIES "")
  foreach(SHADER ${SHADERS})
    get_filename_component(NAME ${SHADER} NAME)
    file(READ ${SHADER} TEXT)
    string(APPEND ENTRIES "    {\"${NAME}\", R\"glsl(${TEXT})glsl\"},\n")
  endforeach()
  file(WRITE ${OUTPUT} "#include \"render/embedded_shaders.h\"

namespace cradle {

const std::map<std::string, std::string>& embeddedShaders() {
  static const std::map<std::string, std::string> shaders = {
${ENTRIES}  };
  return shaders;
}

}  // namespace cradle
")
  return()
endif()

set(CRADLE_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(cradle_embed_shaders TARGET)
  set(FOLDER ${PROJECT_SOURCE_DIR}/shaders)
  set(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cpp)
  file(GLOB SHADERS CONFIGURE_DEPENDS ${FOLDER}/*.glsl ${FOLDER}/*.vert ${FOLDER}/*.frag)
  add_custom_command(
    OUTPUT ${OUTPUT}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${OUTPUT} -DFOLDER=${FOLDER} -P ${CRADLE_EMBED_SCRIPT}
    DEPENDS ${SHADERS} ${CRADLE_EMBED_SCRIPT}
    COMMENT "Embedding shaders")
  target_sources(${TARGET} PRIVATE ${OUTPUT})
endfunction()
