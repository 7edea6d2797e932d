// What people and tools get of the cameras of a plant: a large picture, camera_info, tf.
// SPDX-License-Identifier: BSD-3-Clause
#include "view_publisher.h"

#include <ddm_plant_plugin/picture_message.h>
#include <image_transport/image_transport.h>
#include <ros/console.h>

#include <stdexcept>
#include <utility>

#include "camera_info.h"
#include "ddm_msgs/topics.h"

namespace ddm {
namespace {

constexpr int kViewQueueSize = 2;  // a view is large, and an old one worth nothing

}  // namespace

ViewPublisher::ViewPublisher(ros::NodeHandle nh, const Plant& plant)
    : plant_(plant), has_view_(plant.viewModel().has_value()) {
  std::vector<geometry_msgs::TransformStamped> frames;
  const auto announce = [&](const std::optional<CameraModel>& camera, const char* topic) {
    if (!camera) return;
    infos_.push_back({nh.advertise<sensor_msgs::CameraInfo>(topic, kViewQueueSize, /*latch=*/true),
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

void ViewPublisher::Info::publish(const ros::Time& stamp) {
  if (publisher.getNumSubscribers() == 0) return;
  message.header.stamp = stamp;
  publisher.publish(message);
}

Picture ViewPublisher::view(const Picture& photograph) const {
  return has_view_ ? plant_.view(plant_.state()) : photograph;
}

void ViewPublisher::publish(const Picture& photograph, const ros::Time& stamp) {
  for (Info& info : infos_) info.publish(stamp);
  if (view_.getNumSubscribers() == 0) return;
  try {
    view_.publish(imageMessage(view(photograph), stamp, frame_));
  } catch (const std::runtime_error& e) {
    ROS_ERROR_STREAM("no more pictures for people: " << e.what());
    view_.shutdown();
  }
}

}  // namespace ddm
