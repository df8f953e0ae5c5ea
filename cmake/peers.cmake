# cradle_link_peers(TARGET): takes the units of the engines that studies compare with out of a target, or, without
# CRADLE_PEERS, what stands in for them.
function(cradle_link_peers TARGET)
  get_target_property(SOURCES ${TARGET} SOURCES)
  if(CRADLE_PEERS)
    list(FILTER SOURCES EXCLUDE REGEX "/peers/no_peers.cpp$")
    set(ENGINES ${SOURCES})
    list(FILTER ENGINES INCLUDE REGEX "/peers/(bullet|mujoco|ode|simbody).cpp$")
    set_source_files_properties(${ENGINES} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # no engine's headers meet another's
    target_compile_definitions(${TARGET} PRIVATE BT_USE_DOUBLE_PRECISION dIDEDOUBLE)  # as Debian builds them
    target_include_directories(${TARGET} SYSTEM PRIVATE ${PEER_INCLUDES})
    target_link_libraries(${TARGET} PRIVATE ${PEER_LIBRARIES})
  else()
    list(FILTER SOURCES EXCLUDE REGEX "/peers/(bullet|joint_tree|mujoco|ode|peer_shapes|peers|simbody)")
  endif()
  set_target_properties(${TARGET} PROPERTIES SOURCES "${SOURCES}")
endfunction()
