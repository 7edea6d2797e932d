# Build settings that all packages of this repository share. They stand here because every package depends on
# ddm_msgs: types of Eigen must be compiled for one instruction set everywhere, or their layouts differ.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)  # unoptimised Eigen is painfully slow
endif()

option(DDM_NATIVE "Build for the instruction set of this machine" ${DDM_NATIVE_DEFAULT})  # see ddm_native.cmake.in
option(DDM_WERROR "Treat warnings as errors" OFF)

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

add_compile_options(-Wall -Wextra)
if(DDM_NATIVE)
  # GCC 12 sees uninitialised values in its own AVX-512 header, where there are none.
  add_compile_options(-march=native -Wno-maybe-uninitialized -Wno-uninitialized)
endif()
if(DDM_WERROR)
  add_compile_options(-Werror)
endif()
