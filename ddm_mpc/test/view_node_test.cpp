// Tests of view_node from outside: both images, pixel by pixel, and bad messages.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/Plan.h>
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <limits>
#include <optional>

#include "node_client.h"
#include "view_images.h"

namespace ddm {
namespace {

constexpr int kSize = 8;     // as in view_node.test
constexpr int kPanel = 256;  // 32 times as large

Ddm modelOfSeed(unsigned seed) {
  RandomModelOptions options;
  options.seed = seed;
  return randomModel(options);
}

/// Images are shown once each, all tests together: view_node remembers them, and so does this.
std::vector<Image>& shownImages() {
  static std::vector<Image> images;
  return images;
}

class ViewNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(client_.connect());
    ASSERT_TRUE(waitUntil([this] {
      return plan_.getNumSubscribers() > 0 && prediction_.connected() && plane_->connected();
    }));
  }

  ros::Time showImage(unsigned seed) {
    shownImages().push_back(randomImage(kSize, seed));
    return client_.publishImage(kSize, seed);
  }

  /// A plan whose features are drawn at random.
  static ddm_msgs::Plan randomPlan(unsigned seed) {
    ddm_msgs::Plan plan;
    plan.horizon = 5;
    const Eigen::MatrixXd features = 0.5 * testing::randomMatrix(2, 6, seed);
    plan.feature.assign(features.data(), features.data() + features.size());
    return plan;
  }

  static Image lastPredicted(const Ddm& model, const ddm_msgs::Plan& plan) {
    return model.decode(Eigen::Map<const Eigen::VectorXd>(
        &plan.feature[plan.feature.size() - model.featureDim()], model.featureDim()));
  }

  /// The newest prediction image has these three panels; no grey values stand for a black one.
  bool panelsAre(const std::vector<Image>& panels) const {
    if (prediction_.messages.empty()) return false;
    const sensor_msgs::Image& image = prediction_.messages.back();
    for (int i = 0; i < 3; ++i) {
      for (int row = 0; row < kPanel; ++row) {
        for (int column = 0; column < kPanel; ++column) {
          const std::size_t at = (row * kSize / kPanel) * kSize + column * kSize / kPanel;
          const std::uint8_t expected = panels[i].empty() ? 0 : panels[i][at];
          if (image.data[row * image.step + i * (kPanel + 3) + column] != expected) return false;
        }
      }
    }
    return true;
  }

  /// The newest image of the feature space is the one drawn here.
  bool planeIs(const Ddm& model, const ddm_msgs::Plan& plan) const {
    if (plane_->messages.empty()) return false;
    FeatureOverlay overlay;
    overlay.experience.resize(2, shownImages().size());
    for (std::size_t i = 0; i < shownImages().size(); ++i) {
      overlay.experience.col(i) = model.encode(shownImages()[i]);
    }
    overlay.current = overlay.experience.rightCols(1);
    overlay.goal = model.goalFeature();
    overlay.plan =
        Eigen::Map<const Eigen::MatrixXd>(plan.feature.data(), 2, plan.feature.size() / 2);
    const cv::Mat expected = FeaturePlane(model).draw(overlay);
    return plane_->messages.back().data ==
           std::vector<std::uint8_t>(expected.datastart, expected.dataend);
  }

  NodeClient client_;
  ros::Publisher plan_{client_.nh.advertise<ddm_msgs::Plan>(topics::kPlan, 10)};
  Listener<sensor_msgs::Image> prediction_{client_.nh, topics::kPredictionImage};
  std::optional<Listener<sensor_msgs::Image>> plane_{std::in_place, client_.nh,
                                                     topics::kFeatureSpaceImage};
};

TEST_F(ViewNodeTest, ShowsTheCameraImageAloneWithoutAModel) {
  showImage(1);
  EXPECT_TRUE(waitUntil([this] { return panelsAre({shownImages().back(), {}, {}}); }));
  EXPECT_TRUE(plane_->messages.empty());
}

TEST_F(ViewNodeTest, ShowsImageReconstructionAndPredictionSideBySideUntilAPlanFails) {
  const Ddm model = modelOfSeed(21);
  const ddm_msgs::Plan plan = randomPlan(1);
  client_.publish(modelMessage(model));
  const ros::Time stamp = showImage(2);
  const Image& seen = shownImages().back();
  ASSERT_TRUE(waitUntil([&] {
    plan_.publish(plan);  // again and again: a plan that comes before the model is forgotten
    return panelsAre({seen, model.decode(model.encode(seen)), lastPredicted(model, plan)});
  }));
  const sensor_msgs::Image& image = prediction_.messages.back();
  EXPECT_EQ(image.header.stamp, stamp);
  EXPECT_EQ(image.header.frame_id, "camera");
  EXPECT_EQ(image.encoding, sensor_msgs::image_encodings::MONO8);
  EXPECT_EQ(image.height, static_cast<std::uint32_t>(kPanel + kPanelCaption));
  EXPECT_EQ(image.width, static_cast<std::uint32_t>(3 * kPanel + 6));
  ddm_msgs::Plan failed;
  failed.horizon = 5;
  failed.status = ddm_msgs::Plan::FAILED;
  plan_.publish(failed);
  EXPECT_TRUE(waitUntil([&] { return panelsAre({seen, model.decode(model.encode(seen)), {}}); }));
}

TEST_F(ViewNodeTest, ShowsTheFeatureSpaceWithExperienceCurrentGoalAndPlan) {
  const Ddm model = modelOfSeed(22);
  client_.publish(modelMessage(model));
  showImage(3);
  const ddm_msgs::Plan plan = randomPlan(2);
  ASSERT_TRUE(waitUntil([&] {
    plan_.publish(plan);  // again and again: a plan that comes before the model is forgotten
    return planeIs(model, plan);
  }));
  const sensor_msgs::Image& image = plane_->messages.back();
  EXPECT_EQ(image.encoding, sensor_msgs::image_encodings::RGB8);
  EXPECT_EQ(image.width, static_cast<std::uint32_t>(FeaturePlane::kWidth));
  EXPECT_EQ(image.height, image.width);
}

TEST_F(ViewNodeTest, ForgetsThePlanWithTheModelAndShowsTheLastStateToSomebodyWhoComesLate) {
  const Ddm model = modelOfSeed(24);
  client_.publish(modelMessage(model));
  ASSERT_TRUE(waitUntil([&] { return planeIs(model, ddm_msgs::Plan()); }));
  plane_.emplace(client_.nh, topics::kFeatureSpaceImage);
  EXPECT_TRUE(waitUntil([&] { return planeIs(model, ddm_msgs::Plan()); }));
}

TEST_F(ViewNodeTest, DropsBadMessagesWithAWarningAndGoesOn) {
  const Ddm model = modelOfSeed(26);
  client_.publish(modelMessage(model));
  ASSERT_TRUE(waitUntil([&] { return planeIs(model, ddm_msgs::Plan()); }));

  sensor_msgs::Image image = encodeImage(randomImage(kSize, 5), kSize, client_.nextStamp(), "");
  image.encoding = "colourful";
  ddm_msgs::Plan not_finite = randomPlan(4);
  not_finite.feature[3] = std::numeric_limits<double>::quiet_NaN();
  ddm_msgs::Plan too_long = randomPlan(5);
  too_long.horizon = 4000000000U;
  ddm_msgs::Plan other_size = randomPlan(6);
  other_size.feature.pop_back();
  RandomModelOptions large;
  large.image_size = kSize + 1;
  for (const char* part : {"image on /camera/image_raw", "plan on /plan", "model not"}) {
    EXPECT_TRUE(waitUntil([&] {
      client_.publish(image);
      plan_.publish(not_finite);
      plan_.publish(too_long);
      plan_.publish(other_size);
      client_.publish(modelMessage(randomModel(large)));
      client_.publish(damagedModelMessage());
      return client_.logged(part);
    })) << part;
  }

  showImage(6);
  const Image& seen = shownImages().back();
  const ddm_msgs::Plan plan = randomPlan(7);
  EXPECT_TRUE(waitUntil([&] {
    plan_.publish(plan);
    return panelsAre({seen, model.decode(model.encode(seen)), lastPredicted(model, plan)});
  }));
}

}  // namespace
}  // namespace ddm
