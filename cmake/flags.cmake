# Flags that hold for the whole program.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

# Same input, same bits on every CPU: no fused multiply-add, and Eigen's templates in one flavour only.
add_compile_options(-ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE)

# For libraries of others: code that can be loaded anywhere, whose names are not seen outside of what it is linked into,
# and an Eigen of our own, since a program that is compiled with AVX has another one of the same name.
add_compile_options(-fPIC -fvisibility=hidden $<$<COMPILE_LANGUAGE:CXX>:-fvisibility-inlines-hidden>)
add_compile_definitions(Eigen=CradleEigen)

add_compile_options(-Wall -Wextra -Wconversion -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-Wno-restrict -Wno-array-bounds)  # false alarms of g++ 12 inside std::string
else()
  add_compile_options(-Wno-unknown-pragmas)  # clang proves at run time what g++ is told by "ivdep"
endif()

if(CRADLE_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")  # half the compile time of -O2 -g; line numbers stay
  # Without the checks of every access that the address sanitizer makes as well: they cost half of the compile time.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow
    -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
if(CRADLE_FUZZ)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=fuzzer-no-link>)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
