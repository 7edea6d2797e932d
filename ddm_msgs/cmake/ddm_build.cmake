# Build settings of all packages of this repository. Every package depends on ddm_msgs, so all packages use the same
# instruction set. With different instruction sets the memory layouts of Eigen's types would differ.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)  # Eigen is very slow without optimisation
endif()

if(NOT DEFINED DDM_AVX2_DEFAULT)  # see ddm_avx2.cmake.in
  set(DDM_AVX2_DEFAULT ON)
endif()
option(DDM_AVX2 "On x86-64, build for processors with AVX2 and FMA, which most have since 2013" ${DDM_AVX2_DEFAULT})
option(DDM_WERROR "Treat warnings as errors" OFF)
set(DDM_SANITIZE "" CACHE STRING "Sanitizers: empty for none, address (with undefined behaviour) or thread")

# The catkin of Debian 11 caches that it has found gtest and gmock, but not their targets. Without this line, catkin
# does not search for them when a workspace is configured again, and no test links.
unset(GMOCK_FOUND CACHE)

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

add_compile_options(-Wall -Wextra)
# Results must be identical on other processors. Therefore the build uses a fixed instruction set instead of
# -march=native, and Eigen must not split its sums by the cache sizes of this processor.
add_compile_definitions(EIGEN_NO_CPUID)
if(DDM_AVX2 AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  add_compile_options(-march=haswell)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 reports false reads beyond Eigen's vectors of two and three numbers. GCC 14 uses another name for this
    # warning, which GCC 9 ignores. The Debug build with Clang still checks for such reads.
    add_compile_options(-Wno-array-bounds -Wno-stringop-overread)
  endif()
  if(NOT CMAKE_CROSSCOMPILING)
    include(CheckCXXSourceRuns)
    check_cxx_source_runs("int main() { return !__builtin_cpu_supports(\"avx2\") || !__builtin_cpu_supports(\"fma\"); }"
                          DDM_AVX2_RUNS_HERE)
    if(NOT DDM_AVX2_RUNS_HERE)
      message(FATAL_ERROR "DDM_AVX2 must be OFF on this processor, which has no AVX2 or no FMA, got ON. "
                          "Remedy: run cmake with -DDDM_AVX2=OFF, or demo.sh with the environment variable DDM_AVX2=OFF.")
    endif()
  endif()
endif()
if(DDM_WERROR)
  add_compile_options(-Werror)
endif()
# Other libraries, such as Ceres, contain Eigen functions of the same names that are compiled for another instruction
# set. If DDM exported its Eigen functions, these libraries would call them, and aligned loads would fault on their memory.
set(DDM_VERSION_SCRIPT ${CMAKE_BINARY_DIR}/without_eigen.map)
file(WRITE ${DDM_VERSION_SCRIPT} "{ local: _ZN5Eigen*; _ZNK5Eigen*; _ZZN5Eigen*; _ZZNK5Eigen*; _ZGVZN5Eigen*; _ZGVZNK5Eigen*; };\n")
add_link_options(-Wl,--version-script=${DDM_VERSION_SCRIPT})

# The runtime of a sanitizer is linked into programs only, and a program without the runtime cannot load a library of a
# sanitizer build. A sanitizer build therefore needs its own folders and must not be installed.
set(DDM_INSTRUMENTATION)
set(DDM_FUZZ OFF)
if(DDM_SANITIZE STREQUAL "address")
  set(DDM_INSTRUMENTATION -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # libFuzzer is part of Clang
    set(DDM_FUZZ ON)
    list(APPEND DDM_INSTRUMENTATION -fsanitize=fuzzer-no-link)
  endif()
elseif(DDM_SANITIZE STREQUAL "thread")
  set(DDM_INSTRUMENTATION -fsanitize=thread -fno-omit-frame-pointer)
elseif(DDM_SANITIZE)
  message(FATAL_ERROR "DDM_SANITIZE must be empty, address or thread, got '${DDM_SANITIZE}'. "
                      "Remedy: run cmake with -DDDM_SANITIZE=address, or with -DDDM_SANITIZE= for none.")
endif()
add_compile_options(${DDM_INSTRUMENTATION})
link_libraries(${DDM_INSTRUMENTATION})

# Adds the program PACKAGE_fuzz from fuzz/fuzz.cpp, with the fuzz targets of the package. The arguments are the
# libraries of the program. `make fuzz_targets` builds these programs of all packages.
function(ddm_add_fuzz_targets)
  if(NOT DDM_FUZZ)
    return()
  endif()
  if(NOT TARGET fuzz_targets)
    add_custom_target(fuzz_targets)
  endif()
  add_executable(${PROJECT_NAME}_fuzz fuzz/fuzz.cpp)
  add_dependencies(fuzz_targets ${PROJECT_NAME}_fuzz)
  target_link_libraries(${PROJECT_NAME}_fuzz -fsanitize=fuzzer ${ARGN})
endfunction()
