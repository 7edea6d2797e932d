# The libraries of ddm_msgs with their headers, as targets ddm_common, ddm_images and ddm_node. They are not part of
# ddm_msgs_LIBRARIES or catkin_LIBRARIES, so a package that needs messages only links neither OpenCV nor yaml-cpp.
if(NOT TARGET ddm_common)  # catkin_make builds all packages together
  include(${ddm_msgs_DIR}/ddm_msgs_libraries.cmake)
endif()
