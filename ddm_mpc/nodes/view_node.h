// view_node: shows what the model sees, expects and knows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/Plan.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "feature_plane.h"

namespace ddm {

/// Publishes `prediction_image`, `feature_space_image` and `feature_space_markers`, at most ten
/// times a second each and only while somebody looks. Whatever cannot be shown is left out with a
/// warning: a picture is no reason to end.
class ViewNode {
 public:
  /// @param image_size  size that images are brought to, the model's
  ViewNode(ros::NodeHandle nh, int image_size);

 private:
  /// An image of the experience. It is kept as it was seen, because each new model puts it
  /// elsewhere.
  struct SeenImage {
    Grey grey;
    Eigen::VectorXd feature;  // empty: not yet encoded by the current model
  };
  template <class Publisher>
  struct Output {
    Publisher publisher;
    bool outdated = false;
  };
  using ImageOutput = Output<image_transport::Publisher>;

  void onImage(const sensor_msgs::ImageConstPtr& message);
  void onModel(const ddm_msgs::ModelConstPtr& message);
  void onPlan(const ddm_msgs::PlanConstPtr& message);
  void onTick();

  void advertise(const char* topic, ImageOutput* output);
  void markOutdated();
  /// Predicted features of the latest plan, empty if there is none that the model can show.
  Eigen::MatrixXd planFeatures() const;
  sensor_msgs::ImagePtr drawPrediction() const;
  const FeaturePlane& plane();
  FeatureOverlay overlay();
  sensor_msgs::ImagePtr drawFeatureSpace();
  visualization_msgs::MarkerArrayPtr drawMarkers();

  int image_size_;
  std::optional<Ddm> model_;
  std::optional<FeaturePlane> plane_;  // empty: not yet drawn for this model
  std::string model_id_;
  ddm_msgs::PlanConstPtr plan_;
  std::deque<SeenImage> seen_;  // newest last
  std_msgs::Header header_;     // of the newest image

  image_transport::ImageTransport transport_;
  ImageOutput prediction_;
  ImageOutput feature_space_;
  Output<ros::Publisher> markers_;
  bool grid_outdated_ = false;  // markers that change with the model alone; they are large
  ros::Subscriber model_sub_;
  ros::Subscriber plan_sub_;
  image_transport::Subscriber image_sub_;
  ros::WallTimer timer_;
};

}  // namespace ddm
