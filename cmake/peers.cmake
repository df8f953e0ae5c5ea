# cradle_link_peers(TARGET): takes the units of the engines that studies compare with out of a target, or, without
# CRADLE_PEERS, those that stand in for them.
function(cradle_link_peers TARGET)
  get_target_property(SOURCES ${TARGET} SOURCES)
  if(CRADLE_PEERS)
    list(FILTER SOURCES EXCLUDE REGEX "/peers/no_bullet.cpp$")
    target_compile_definitions(${TARGET} PRIVATE BT_USE_DOUBLE_PRECISION)  # as Debian builds it
    target_include_directories(${TARGET} SYSTEM PRIVATE ${BULLET_INCLUDE})
    target_link_libraries(${TARGET} PRIVATE ${BULLET_LIBRARIES})
  else()
    list(FILTER SOURCES EXCLUDE REGEX "/peers/bullet(_shapes)?.cpp$")
  endif()
  set_target_properties(${TARGET} PROPERTIES SOURCES "${SOURCES}")
endfunction()
