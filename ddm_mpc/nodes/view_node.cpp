// view_node: shows what the model sees, expects and knows.
// SPDX-License-Identifier: BSD-3-Clause
#include <cv_bridge/cv_bridge.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/image_options.h>
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

#include "pictures.h"

namespace ddm {
namespace {

constexpr int kQueue = 10;
constexpr double kWarnPeriod = 5.0;        // [s]
constexpr std::size_t kMaxSeen = 2000;     // images of experience
constexpr std::uint32_t kMaxSteps = 1000;  // of a plan, as in the rules of mpc/horizon
const ros::WallDuration kTick(0.1);

/// @throws std::invalid_argument if the plan cannot be drawn
void requireDrawable(const ddm_msgs::Plan& plan) {
  if (plan.status == ddm_msgs::Plan::FAILED) return;
  if (plan.horizon > kMaxSteps) {
    throw std::invalid_argument("it has " + std::to_string(plan.horizon) + " steps, at most " +
                                std::to_string(kMaxSteps) + " can be drawn");
  }
  for (const double value : plan.feature) {
    if (!std::isfinite(value)) throw std::invalid_argument("it holds features that are not finite");
  }
}

/// Publishes `prediction_image` and `feature_space_image`, each at most ten times a second and only
/// while it has a subscriber. If something cannot be shown, the node warns,
/// leaves it out and goes on.
class ViewNode {
 public:
  /// @param image_size  size that images are brought to, the model's
  ViewNode(ros::NodeHandle nh, int image_size) : image_size_(image_size), transport_(nh) {
    advertise(topics::kPredictionImage, &prediction_);
    advertise(topics::kFeatureSpaceImage, &feature_space_);
    model_sub_ = nh.subscribe(topics::kModel, 1, &ViewNode::onModel, this);
    plan_sub_ = nh.subscribe(topics::kPlan, kQueue, &ViewNode::onPlan, this);
    image_sub_ = transport_.subscribe(topics::kImage, kQueue, &ViewNode::onImage, this);
    timer_ = nh.createWallTimer(kTick, [this](const ros::WallTimerEvent&) { onTick(); });
  }

 private:
  /// An image of the experience. It is kept as it was seen, because each new model puts it
  /// elsewhere.
  struct SeenImage {
    Grey grey;
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
        throw std::invalid_argument("its images have size " + std::to_string(model.imageSize()) +
                                    ", this node has image/size " + std::to_string(image_size_) +
                                    ": start both with the same configuration");
      }
      if (model_) plan_.reset();  // a plan in the features of the last model means nothing in these
      model_ = std::move(model);
    } catch (const std::exception& e) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "model not shown: " << e.what());
      return;
    }
    model_id_ = id;
    plane_.reset();
    for (SeenImage& seen : seen_) seen.feature.resize(0);
    markOutdated();
  }

  void onPlan(const ddm_msgs::PlanConstPtr& message) {
    try {
      requireDrawable(*message);
    } catch (const std::exception& e) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriod,
                               "plan on " << plan_sub_.getTopic() << " not shown: " << e.what());
      return;
    }
    plan_ = message;
    markOutdated();
  }

  void onTick() {
    const auto show = [](auto* output, const auto& draw) {
      if (!output->outdated || output->publisher.getNumSubscribers() == 0) return;
      output->outdated = false;
      const auto picture = draw();
      if (picture != nullptr) output->publisher.publish(picture);
    };
    show(&prediction_, [this] { return drawPrediction(); });
    show(&feature_space_, [this] { return drawFeatureSpace(); });
  }

  void advertise(const char* topic, Output* output) {
    // Somebody who comes when nothing changes any more wants to see the last state too.
    output->publisher = transport_.advertise(
        topic, 1,
        [output](const image_transport::SingleSubscriberPublisher&) { output->outdated = true; });
  }

  void markOutdated() {
    prediction_.outdated = true;
    feature_space_.outdated = true;
  }

  /// Predicted features of the latest plan, empty if there is none that the model can show.
  Eigen::MatrixXd planFeatures() const {
    if (!model_ || plan_ == nullptr || plan_->status == ddm_msgs::Plan::FAILED) return {};
    const Eigen::Index dim = model_->featureDim();
    const Eigen::Index count = static_cast<Eigen::Index>(plan_->horizon) + 1;
    if (static_cast<Eigen::Index>(plan_->feature.size()) != dim * count) {
      ROS_WARN_STREAM_THROTTLE(
          kWarnPeriod, "plan on " << plan_sub_.getTopic() << " not shown: " << plan_->feature.size()
                                  << " numbers for " << count << " features of size " << dim);
      return {};
    }
    return Eigen::Map<const Eigen::MatrixXd>(plan_->feature.data(), dim, count);
  }

  /// The image just seen, its reconstruction, the last image of the plan. A panel whose image is not
  /// known stays black.
  sensor_msgs::ImagePtr drawPrediction() const {
    if (seen_.empty()) return nullptr;
    std::vector<Panel> panels = {
        {seen_.back().grey, "camera"}, {{}, "reconstruction"}, {{}, "prediction"}};
    if (model_) {
      panels[1].grey = model_->decode(model_->encode(seen_.back().grey));
      const Eigen::MatrixXd features = planFeatures();
      if (features.cols() > 0) {
        panels[2].grey = model_->decode(features.rightCols(1));
        panels[2].caption += ", " + std::to_string(features.cols() - 1) + " steps ahead";
      }
    }
    return cv_bridge::CvImage(header_, sensor_msgs::image_encodings::MONO8,
                              drawPanels(panels, image_size_))
        .toImageMsg();
  }

  const FeaturePlane& plane() {
    if (!plane_) plane_.emplace(*model_);
    return *plane_;
  }

  FeatureOverlay overlay() {
    FeatureOverlay overlay;
    overlay.experience.resize(model_->featureDim(), static_cast<Eigen::Index>(seen_.size()));
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (seen_[i].feature.size() == 0) seen_[i].feature = model_->encode(seen_[i].grey);
      overlay.experience.col(static_cast<Eigen::Index>(i)) = seen_[i].feature;
    }
    if (!seen_.empty()) overlay.current = seen_.back().feature;
    if (model_->hasGoal()) overlay.goal = model_->goalFeature();
    overlay.plan = planFeatures();
    const bool planned = overlay.plan.cols() > 0;
    if (planned && static_cast<int>(plan_->goal_feature.size()) == model_->featureDim()) {
      overlay.goal = Eigen::Map<const Eigen::VectorXd>(plan_->goal_feature.data(),
                                                       model_->featureDim());  // may not be its own
    }
    return overlay;
  }

  sensor_msgs::ImagePtr drawFeatureSpace() {
    if (!model_) return nullptr;
    return cv_bridge::CvImage(header_, sensor_msgs::image_encodings::RGB8, plane().draw(overlay()))
        .toImageMsg();
  }

  int image_size_;
  std::optional<Ddm> model_;
  std::optional<FeaturePlane> plane_;  // empty: not yet drawn for this model
  std::string model_id_;
  ddm_msgs::PlanConstPtr plan_;
  std::deque<SeenImage> seen_;  // newest last
  std_msgs::Header header_;     // of the newest image

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
    params->ignore("image_transport");  // read by image_transport itself
    const auto image = params->read<ddm::ImageOptions>("image");
    params->requireValid();
    ROS_INFO_STREAM("view_node runs with\n" << ddm::toYaml(image));
    ddm::ViewNode node(nh, image.size);
    ros::spin();
  });
}
