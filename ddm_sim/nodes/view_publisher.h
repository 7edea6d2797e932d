// What people and tools get of the cameras of a plant: a large picture, camera_info, tf.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_plant_plugin/picture_message.h>
#include <image_transport/image_transport.h>
#include <ros/console.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "camera_info.h"
#include "ddm_msgs/topics.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// The view is drawn while somebody subscribes, and never else: it costs many times more than the
/// learner's picture. A plant without a view shows people what its camera shows, and a plant without
/// a real camera has no camera_info and no frame in tf.
class ViewPublisher {
 public:
  /// @param nh     its namespace holds the topics
  /// @param plant  must outlive this object
  ViewPublisher(ros::NodeHandle nh, const Plant& plant)
      : plant_(plant), has_view_(plant.viewModel().has_value()) {
    std::vector<geometry_msgs::TransformStamped> frames;
    const auto announce = [&](const std::optional<CameraModel>& camera, const char* topic) {
      if (!camera) return;
      infos_.push_back(
          {nh.advertise<sensor_msgs::CameraInfo>(topic, kViewQueueSize, /*latch=*/true),
           cameraInfoOf(*camera)});
      infos_.back().publisher.publish(infos_.back().message);
      const bool known = !frames.empty() && frames.front().child_frame_id == opticalFrame(camera);
      if (camera->fixed && !known) frames.push_back(opticalFrameOf(*camera));
    };
    announce(plant.cameraModel(), topics::kImageInfo);
    announce(plant.viewModel(), topics::kViewInfo);
    frame_ = opticalFrame(has_view_ ? plant.viewModel() : plant.cameraModel());
    if (!frames.empty()) tf_.emplace().sendTransform(frames);
    view_ = image_transport::ImageTransport(nh).advertise(topics::kView, kViewQueueSize);
  }

  /// The view of the present state of the plant, and camera_info for those who want one with each
  /// image. A view that cannot be drawn ends the views, not the trial.
  /// @param photograph  what the camera shows of the state
  void publish(const Picture& photograph, const ros::Time& stamp) {
    for (Info& info : infos_) info.publish(stamp);
    if (view_.getNumSubscribers() == 0) return;
    try {
      const Picture view = has_view_ ? plant_.view(plant_.state()) : photograph;
      view_.publish(imageMessage(view, stamp, frame_));
    } catch (const std::runtime_error& e) {
      ROS_ERROR_STREAM("no more pictures for people: " << e.what());
      view_.shutdown();
    }
  }

 private:
  /// The camera_info of one camera.
  struct Info {
    ros::Publisher publisher;
    sensor_msgs::CameraInfo message;

    void publish(const ros::Time& stamp) {
      if (publisher.getNumSubscribers() == 0) return;
      message.header.stamp = stamp;
      publisher.publish(message);
    }
  };

  static constexpr int kViewQueueSize = 2;  // a view is large, and an old one worth nothing

  const Plant& plant_;
  bool has_view_;
  std::string frame_;  ///< of the view
  std::vector<Info> infos_;
  image_transport::Publisher view_;
  std::optional<tf2_ros::StaticTransformBroadcaster> tf_;  ///< none where no camera is fixed
};

}  // namespace ddm
