# The libraries of ddm_msgs as targets ddm_common, ddm_images and ddm_node, headers included. They are not part
# of ddm_msgs_LIBRARIES, nor of catkin_LIBRARIES: who needs messages only links neither OpenCV nor yaml-cpp.
if(NOT TARGET ddm_common)  # catkin_make builds all packages together
  include(${ddm_msgs_DIR}/ddm_msgs_libraries.cmake)
endif()
