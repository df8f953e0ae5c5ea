# Debian 12 packages. Each is used by one unit of the program (Eigen and fmt aside).
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(assimp 5.2 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(SQLite3 3.40 REQUIRED)
find_package(Threads REQUIRED)
find_library(LIBDEFLATE deflate REQUIRED)
if(CRADLE_TESTS OR NOT CRADLE_EGL)  # the tests hold one context against the other
  find_library(OSMESA OSMesa REQUIRED)
endif()
if(CRADLE_TESTS OR CRADLE_EGL)
  find_library(EGL EGL REQUIRED)
  find_library(OPENGL OpenGL REQUIRED)  # the functions alone, without GLX
endif()
find_library(GLEW NAMES libGLEW.a REQUIRED)
find_path(STB_INCLUDE stb/stb_image_write.h REQUIRED)
find_package(Qhull 8 REQUIRED)

if(CRADLE_PEERS)
  find_path(BULLET_INCLUDE btBulletDynamicsCommon.h PATH_SUFFIXES bullet REQUIRED)
  foreach(NAME BulletDynamics BulletCollision LinearMath)  # in double precision
    find_library(BULLET_${NAME} ${NAME}-float64 REQUIRED)
    list(APPEND BULLET_LIBRARIES ${BULLET_${NAME}})
  endforeach()
endif()
