// What people and tools get of the cameras of a plant: a large picture, camera_info, tf.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/publisher.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <optional>
#include <string>
#include <vector>

#include "ddm_sim/plant.h"

namespace ddm {

/// The view is drawn while somebody subscribes, and never else: it costs many times more than the
/// learner's picture. A plant without a view shows people what its camera shows, and a plant without
/// a real camera has no camera_info and no frame in tf.
class ViewPublisher {
 public:
  /// @param nh     its namespace holds the topics
  /// @param plant  must outlive this object
  ViewPublisher(ros::NodeHandle nh, const Plant& plant);

  /// The view of the present state of the plant, and camera_info for those who want one with each
  /// image. A view that cannot be drawn ends the views, not the trial.
  /// @param photograph  what the camera shows of the state
  void publish(const Picture& photograph, const ros::Time& stamp);

 private:
  /// The camera_info of one camera.
  struct Info {
    ros::Publisher publisher;
    sensor_msgs::CameraInfo message;

    void publish(const ros::Time& stamp);
  };

  Picture view(const Picture& photograph) const;

  const Plant& plant_;
  bool has_view_;
  std::string frame_;  ///< of the view
  std::vector<Info> infos_;
  image_transport::Publisher view_;
  std::optional<tf2_ros::StaticTransformBroadcaster> tf_;  ///< none where no camera is fixed
};

}  // namespace ddm
