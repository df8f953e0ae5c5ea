# The engines that studies compare with, and what stands in for them: of these a program that has cradle_study has one.
# Their libraries take longer to load than all else that the program begins with.
set(PEERS ${PROJECT_SOURCE_DIR}/src/study/peers)
add_library(cradle_no_peers OBJECT ${PEERS}/no_peers.cpp)
target_link_libraries(cradle_no_peers PUBLIC cradle_study)
target_precompile_headers(cradle_no_peers REUSE_FROM cradle_headers)
if(CRADLE_PEERS)
  foreach(NAME bullet mujoco ode simbody)
    list(APPEND ENGINES ${PEERS}/${NAME}.cpp)
  endforeach()
  foreach(NAME bullet_shapes joint_tree mujoco_model peer_drives peer_shapes peers)
    list(APPEND SHARED_BY_ENGINES ${PEERS}/${NAME}.cpp)
  endforeach()
  add_library(cradle_peers OBJECT ${ENGINES} ${SHARED_BY_ENGINES})
  set_target_properties(cradle_peers PROPERTIES UNITY_BUILD ON)
  set_source_files_properties(${ENGINES} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # no engine's headers meet another's
  target_compile_definitions(cradle_peers PRIVATE BT_USE_DOUBLE_PRECISION dIDEDOUBLE)  # as Debian builds them
  target_include_directories(cradle_peers SYSTEM PRIVATE ${PEER_INCLUDES})
  target_link_libraries(cradle_peers PUBLIC cradle_study ${PEER_LIBRARIES})
  target_precompile_headers(cradle_peers REUSE_FROM cradle_headers)
endif()

# cradle_link_peers(TARGET): gives a program the engines, if there are any.
function(cradle_link_peers TARGET)
  if(CRADLE_PEERS)
    target_link_libraries(${TARGET} PRIVATE cradle_peers)
  else()
    target_link_libraries(${TARGET} PRIVATE cradle_no_peers)
  endif()
endfunction()
