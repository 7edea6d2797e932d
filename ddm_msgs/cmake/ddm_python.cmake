# Python bindings of the packages, which use pybind11.
option(DDM_PYTHON "Build the Python bindings if pybind11 is installed" ON)

# Whether this package gets bindings. A Python interpreter cannot load libraries of a sanitizer build.
set(DDM_BINDINGS OFF)
if(DDM_PYTHON AND NOT DDM_SANITIZE AND EXISTS ${PROJECT_SOURCE_DIR}/python/core.cpp)
  set(PYBIND11_PYTHON_VERSION ${PYTHON_VERSION})  # the version that catkin uses
  # Newer versions of catkin, as in Debian 13, find the interpreter by CMake's module Python. pybind11 then uses this
  # module, too, and needs the headers from it.
  set(headers_found TRUE)
  if(Python_FOUND)
    find_package(Python ${PYTHON_VERSION} QUIET COMPONENTS Interpreter Development.Module)
    set(headers_found ${Python_FOUND})
  endif()
  if(headers_found)
    find_package(pybind11 2.4 QUIET)
  endif()
  if(headers_found AND pybind11_FOUND)
    set(DDM_BINDINGS ON)
  else()
    message(STATUS "${PROJECT_NAME}: without Python bindings; they need pybind11-dev and python3-dev")
  endif()
endif()

# Adds the Python module PACKAGE._core from python/core.cpp, and installs the type hints of the package. In devel and in
# install space, the module is in the folder of the Python package. The arguments after the file of the hints are the
# libraries of the module.
function(ddm_add_python_module hints)
  if(NOT DDM_BINDINGS)
    return()
  endif()
  pybind11_add_module(${PROJECT_NAME}_python MODULE NO_EXTRAS python/core.cpp)
  set_target_properties(${PROJECT_NAME}_python PROPERTIES OUTPUT_NAME _core
                        LIBRARY_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_PYTHON_DESTINATION})
  target_link_libraries(${PROJECT_NAME}_python PRIVATE ${ARGN})
  add_dependencies(${PROJECT_NAME}_python ${catkin_EXPORTED_TARGETS})
  install(TARGETS ${PROJECT_NAME}_python LIBRARY DESTINATION ${CATKIN_PACKAGE_PYTHON_DESTINATION})
  install(FILES ${hints} DESTINATION ${CATKIN_PACKAGE_PYTHON_DESTINATION})
endfunction()
