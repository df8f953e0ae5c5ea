# As a script (cmake -DOUTPUT=... -DFONT=... -P): writes a C source that holds the bytes of a font, cradleFont.
# Included: cradle_embed_font(TARGET) adds that source to a target. The font becomes a part of the program, so that a
# text has the same pixels wherever the program runs; its licence (Bitstream Vera) allows that.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ ${FONT} BYTES HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," BYTES "${BYTES}")
  file(WRITE ${OUTPUT} "extern const unsigned char cradleFont[];\nconst unsigned char cradleFont[] = {${BYTES}};\n")
  return()
endif()

set(CRADLE_EMBED_FONT_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(cradle_embed_font TARGET)
  set(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/embedded_font.c)
  add_custom_command(
    OUTPUT ${OUTPUT}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${OUTPUT} -DFONT=${FONT} -P ${CRADLE_EMBED_FONT_SCRIPT}
    DEPENDS ${FONT} ${CRADLE_EMBED_FONT_SCRIPT}
    COMMENT "Embedding the font")
  target_sources(${TARGET} PRIVATE ${OUTPUT})
endfunction()
