# As a script (cmake -DOUTPUT=... -DFILES=... -P): writes a C++ source that holds the files (separated by |) by their names.
# Included: cradle_embed_player(TARGET) adds the source of the player's page to a target, made anew when a file changes.
if(CMAKE_SCRIPT_MODE_FILE)
  string(REPLACE "|" ";" FILES "${FILES}")
  set(ENTRIES "")
  foreach(NAME_OF_FILE ${FILES})
    get_filename_component(NAME ${NAME_OF_FILE} NAME)
    file(READ ${NAME_OF_FILE} TEXT)
    string(APPEND ENTRIES "    {\"${NAME}\", R\"~player~(${TEXT})~player~\"},\n")
  endforeach()
  file(WRITE ${OUTPUT} "#include \"player/embedded_player.h\"

namespace cradle {

const std::map<std::string, std::string>& embeddedPlayer() {
  static const std::map<std::string, std::string> files = {
${ENTRIES}  };
  return files;
}

}  // namespace cradle
")
  return()
endif()

set(CRADLE_EMBED_PLAYER_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(cradle_embed_player TARGET)
  set(FILES ${THREE_JS} ${ORBIT_CONTROLS_JS})
  foreach(NAME player.html player.css player.js)
    list(APPEND FILES ${PROJECT_SOURCE_DIR}/player/${NAME})
  endforeach()
  set(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/embedded_player.cpp)
  string(REPLACE ";" "|" JOINED "${FILES}")
  add_custom_command(
    OUTPUT ${OUTPUT}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${OUTPUT} "-DFILES=${JOINED}" -P ${CRADLE_EMBED_PLAYER_SCRIPT}
    DEPENDS ${FILES} ${CRADLE_EMBED_PLAYER_SCRIPT}
    COMMENT "Embedding the player" VERBATIM)
  target_sources(${TARGET} PRIVATE ${OUTPUT})
  set_source_files_properties(${OUTPUT} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
