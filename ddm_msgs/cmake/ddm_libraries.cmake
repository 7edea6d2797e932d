# The libraries of ddm_msgs as targets ddm_files, ddm_images, ddm_node and ddm_params, headers included. They are not part
# of ddm_msgs_LIBRARIES, nor of catkin_LIBRARIES: who needs messages only links neither OpenCV nor yaml-cpp.
if(NOT TARGET ddm_params)  # catkin_make builds all packages together
  include(${ddm_msgs_DIR}/ddm_msgs_libraries.cmake)
endif()
