// view_node: shows the image, its reconstruction, its prediction and the feature space.
// SPDX-License-Identifier: BSD-3-Clause
#include <cv_bridge/cv_bridge.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/image_options.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/run_node.h>
#include <ddm_model/ddm.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/Plan.h>
#include <ddm_msgs/topics.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "view_images.h"

namespace ddm {
namespace {

constexpr int kQueue = 10;
constexpr double kWarnPeriod = 5.0;     // period of repeated warnings [s]
constexpr std::size_t kMaxSeen = 2000;  // images that the feature space shows at most
const ros::WallDuration kTick(0.1);

/// @return predicted features, one per column; empty if the plan failed
/// @throws std::invalid_argument if features are missing or not finite
Eigen::MatrixXd featuresOf(const ddm_msgs::Plan& plan, std::size_t feature_dim) {
  if (plan.status == ddm_msgs::Plan::FAILED) return {};
  const std::size_t count = static_cast<std::size_t>(plan.horizon) + 1;
  if (plan.feature.size() != feature_dim * count) {
    throw std::invalid_argument(textOf("it has ", plan.feature.size(), " numbers for ", count,
                                       " features of size ", feature_dim));
  }
  const Eigen::Map<const Eigen::MatrixXd> features(plan.feature.data(), feature_dim, count);
  if (!features.allFinite()) throw std::invalid_argument("it holds features that are not finite");
  return features;
}

/// Publishes `prediction_image` and `feature_space_image`, each at most ten times per second and
/// only if it has a subscriber. If something cannot be shown, the node warns and omits it.
class ViewNode {
 public:
  /// @param image_size  width and height of the model's images [pixels]
  ViewNode(ros::NodeHandle nh, int image_size) : image_size_(image_size), transport_(nh) {
    advertise(topics::kPredictionImage, &prediction_);
    advertise(topics::kFeatureSpaceImage, &feature_space_);
    model_sub_ = nh.subscribe(topics::kModel, 1, &ViewNode::onModel, this);
    plan_sub_ = nh.subscribe(topics::kPlan, kQueue, &ViewNode::onPlan, this);
    image_sub_ = transport_.subscribe(topics::kImage, kQueue, &ViewNode::onImage, this);
    timer_ = nh.createWallTimer(kTick, [this](const ros::WallTimerEvent&) { onTick(); });
  }

 private:
  /// An image, kept because each new model encodes it to another feature.
  struct SeenImage {
    Image image;
    Eigen::VectorXd feature;  // empty: not yet encoded by the current model
  };
  struct Output {
    image_transport::Publisher publisher;
    bool outdated = false;
  };

  void onImage(const sensor_msgs::ImageConstPtr& message) {
    try {
      seen_.push_back({decodeImage(*message, image_size_), Eigen::VectorXd()});
    } catch (const std::exception& e) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriod,
                               "image on " << image_sub_.getTopic() << " not shown: " << e.what());
      return;
    }
    if (seen_.size() > kMaxSeen) seen_.pop_front();
    header_ = message->header;
    markOutdated();
  }

  void onModel(const ddm_msgs::ModelConstPtr& message) {
    const std::string bytes(message->data.begin(), message->data.end());
    const std::string id = modelId(bytes);
    if (id == model_id_) return;
    try {
      Ddm model = deserialiseModel(bytes, "on topic " + model_sub_.getTopic());
      if (model.imageSize() != image_size_) {
        throw std::invalid_argument(textOf("its images have size ", model.imageSize(),
                                           ", this node has image/size ", image_size_,
                                           ": start both with the same configuration"));
      }
      model_ = std::move(model);
    } catch (const std::exception& e) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "model not shown: " << e.what());
      return;
    }
    model_id_ = id;
    plane_.reset();
    plan_features_.resize(0, 0);  // its features belong to the last model
    goal_feature_.resize(0);
    for (SeenImage& seen : seen_) seen.feature.resize(0);
    markOutdated();
  }

  /// Ignores plans before the first model.
  void onPlan(const ddm_msgs::PlanConstPtr& message) {
    if (!model_) return;
    try {
      plan_features_ = featuresOf(*message, model_->featureDim());
    } catch (const std::exception& e) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriod,
                               "plan on " << plan_sub_.getTopic() << " not shown: " << e.what());
      return;
    }
    goal_feature_.resize(0);
    if (plan_features_.cols() > 0 &&
        static_cast<int>(message->goal_feature.size()) == model_->featureDim()) {
      goal_feature_ =
          Eigen::Map<const Eigen::VectorXd>(message->goal_feature.data(), plan_features_.rows());
    }
    markOutdated();
  }

  void onTick() {
    const auto show = [](auto* output, const auto& draw) {
      if (!output->outdated || output->publisher.getNumSubscribers() == 0) return;
      output->outdated = false;
      const auto drawing = draw();
      if (drawing != nullptr) output->publisher.publish(drawing);
    };
    show(&prediction_, [this] { return drawPrediction(); });
    show(&feature_space_, [this] { return drawFeatureSpace(); });
  }

  void advertise(const char* topic, Output* output) {
    // A new subscriber gets the current state even if nothing changes any more.
    output->publisher = transport_.advertise(
        topic, 1,
        [output](const image_transport::SingleSubscriberPublisher&) { output->outdated = true; });
  }

  void markOutdated() {
    prediction_.outdated = true;
    feature_space_.outdated = true;
  }

  /// Draws the newest image, its reconstruction, and the last predicted image of the plan. A panel
  /// without an image stays black.
  sensor_msgs::ImagePtr drawPrediction() const {
    if (seen_.empty()) return nullptr;
    std::vector<Panel> panels = {
        {seen_.back().image, "camera"}, {{}, "reconstruction"}, {{}, "prediction"}};
    if (model_) {
      panels[1].image = model_->decode(model_->encode(seen_.back().image));
      if (plan_features_.cols() > 0) {
        panels[2].image = model_->decode(plan_features_.rightCols(1));
        panels[2].caption += ", " + std::to_string(plan_features_.cols() - 1) + " steps ahead";
      }
    }
    return cv_bridge::CvImage(header_, sensor_msgs::image_encodings::MONO8,
                              drawPanels(panels, image_size_))
        .toImageMsg();
  }

  FeatureOverlay overlay() {
    FeatureOverlay overlay;
    overlay.experience.resize(model_->featureDim(), static_cast<Eigen::Index>(seen_.size()));
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (seen_[i].feature.size() == 0) seen_[i].feature = model_->encode(seen_[i].image);
      overlay.experience.col(static_cast<Eigen::Index>(i)) = seen_[i].feature;
    }
    if (!seen_.empty()) overlay.current = seen_.back().feature;
    if (model_->hasGoal()) overlay.goal = model_->goalFeature();
    overlay.plan = plan_features_;
    if (goal_feature_.size() > 0) overlay.goal = goal_feature_;
    return overlay;
  }

  sensor_msgs::ImagePtr drawFeatureSpace() {
    if (!model_) return nullptr;
    if (!plane_) plane_.emplace(*model_);
    return cv_bridge::CvImage(header_, sensor_msgs::image_encodings::RGB8, plane_->draw(overlay()))
        .toImageMsg();
  }

  int image_size_;
  std::optional<Ddm> model_;
  std::optional<FeaturePlane> plane_;  // empty: not yet drawn for this model
  std::string model_id_;
  Eigen::MatrixXd plan_features_;  // of the newest plan; empty: none, or it failed
  Eigen::VectorXd goal_feature_;   // goal of that plan; empty: the model's goal counts
  std::deque<SeenImage> seen_;     // newest last
  std_msgs::Header header_;        // of the newest image

  image_transport::ImageTransport transport_;
  Output prediction_;
  Output feature_space_;
  ros::Subscriber model_sub_;
  ros::Subscriber plan_sub_;
  image_transport::Subscriber image_sub_;
  ros::WallTimer timer_;
};

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  return ddm::runNode("view_node", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
    params->ignore("image_transport");  // image_transport reads it
    const auto image = params->read<ddm::ImageOptions>("image");
    params->requireValid();
    ROS_INFO_STREAM("view_node runs with\n" << ddm::toYaml(image));
    ddm::ViewNode node(nh, image.size);
    ros::spin();
  });
}
