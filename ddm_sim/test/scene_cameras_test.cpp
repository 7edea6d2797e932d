// Tests of the camera data that sim_node publishes: the view for people, camera_info and tf.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/master.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_msgs/TFMessage.h>

#include <set>
#include <string>
#include <vector>

#include "sim_client.h"

namespace ddm {
namespace {

constexpr std::size_t kFrames = 12;
const std::vector<double> kStart{0.3, 2.0};

/// All messages of a topic since the construction.
template <class Message>
class Collected {
 public:
  explicit Collected(const std::string& topic)
      : subscriber_(nh_.subscribe(topic, 1000, &Collected::take, this)) {}

  bool connected() const { return subscriber_.getNumPublishers() > 0; }

  std::vector<Message> messages;

 private:
  void take(const Message& message) { messages.push_back(message); }

  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
};

using Images = Collected<sensor_msgs::Image>;
using Infos = Collected<sensor_msgs::CameraInfo>;

std::set<std::string> topicsThatThereAre() {
  ros::master::V_TopicInfo topics;
  EXPECT_TRUE(ros::master::getTopics(topics));
  std::set<std::string> names;
  for (const ros::master::TopicInfo& topic : topics) names.insert(topic.name);
  return names;
}

class SceneCameras : public SimNodeTest {
 protected:
  /// Runs an episode to its end, with the same torques in each call.
  static void runTrial() {
    client_->forget();
    client_->reset(kFrames, kStart);
    for (std::size_t t = 0; t < kFrames; ++t) {
      ASSERT_TRUE(client_->waitForImages(t + 1));
      client_->publish(client_->images[t].header.stamp, {t % 2 == 0 ? 4.0 : -1.0});
    }
    ASSERT_TRUE(client_->waitForLog("frames answered"));
  }
};

TEST_F(SceneCameras, LatchTheirOpticalFrameAndTheInfoOfTheLearnersImageAndOfTheView) {
  Collected<tf2_msgs::TFMessage> frames("/tf_static");
  Infos small(topics::kImageInfo);
  Infos large(topics::kViewInfo);
  ASSERT_TRUE(client_->waitUntil([&] {
    return !frames.messages.empty() && !small.messages.empty() && !large.messages.empty();
  }));
  ASSERT_EQ(frames.messages[0].transforms.size(), 1U);
  EXPECT_EQ(frames.messages[0].transforms[0].child_frame_id, "front_optical_frame");
  const sensor_msgs::CameraInfo& learner = small.messages[0];
  const sensor_msgs::CameraInfo& people = large.messages[0];
  EXPECT_EQ(learner.width, 51U);
  EXPECT_EQ(learner.height, 51U);
  EXPECT_EQ(people.width, 640U);
  EXPECT_EQ(people.height, 480U);
  // Both images have the same field of view.
  EXPECT_NEAR(people.K[0] / learner.K[0], 480.0 / 51.0, 1e-9);
  EXPECT_EQ(learner.header.frame_id, "front_optical_frame");
  EXPECT_EQ(people.header.frame_id, "front_optical_frame");
}

TEST_F(SceneCameras, ShowPeopleEachFrameInColourAndTheLearnerTheSameWhetherTheyWatchOrNot) {
  runTrial();
  const std::vector<sensor_msgs::Image> unwatched = client_->images;
  const std::vector<sensor_msgs::JointState> truths = client_->truths;
  {
    Images view(topics::kView);
    Infos info(topics::kViewInfo);
    ASSERT_TRUE(client_->waitUntil([&] { return view.connected() && !info.messages.empty(); }));
    info.messages.clear();
    runTrial();
    ASSERT_TRUE(client_->waitUntil(
        [&] { return view.messages.size() >= kFrames && info.messages.size() >= kFrames; }));
    ASSERT_EQ(view.messages.size(), kFrames);
    for (std::size_t t = 0; t < kFrames; ++t) {
      EXPECT_EQ(view.messages[t].header.stamp, client_->images[t].header.stamp) << t;
      EXPECT_EQ(info.messages[t].header.stamp, client_->images[t].header.stamp) << t;
    }
    const sensor_msgs::Image& first = view.messages[0];
    EXPECT_EQ(first.width, 640U);
    EXPECT_EQ(first.height, 480U);
    EXPECT_EQ(first.encoding, "rgb8");
    EXPECT_EQ(first.header.frame_id, "front_optical_frame");
    EXPECT_NE(first.data, view.messages[1].data);
  }
  ASSERT_EQ(unwatched.size(), client_->images.size());
  for (std::size_t t = 0; t < kFrames; ++t) {
    EXPECT_EQ(unwatched[t].data, client_->images[t].data) << t;
    EXPECT_EQ(unwatched[t].header.frame_id, "front_optical_frame");
    EXPECT_EQ(truths[t].position, client_->truths[t].position) << t;
    EXPECT_EQ(truths[t].velocity, client_->truths[t].velocity) << t;
  }
  for (const sensor_msgs::Image& goal : client_->goals) {
    EXPECT_EQ(goal.header.frame_id, "front_optical_frame");
  }
}

TEST_F(SceneCameras, InventNoLensForAPlantWithoutOneAndShowPeopleWhatItsCameraShows) {
  const std::string plain = "/plain/";
  const std::set<std::string> names = topicsThatThereAre();
  EXPECT_EQ(names.count(plain + topics::kView), 1U);
  EXPECT_EQ(names.count(plain + topics::kImageInfo), 0U);
  EXPECT_EQ(names.count(plain + topics::kViewInfo), 0U);
  Images image(plain + topics::kImage);
  Images view(plain + topics::kView);
  ASSERT_TRUE(client_->waitUntil([&] { return image.connected() && view.connected(); }));
  ddm_msgs::Reset call;
  ASSERT_TRUE(client_->waitUntil([&] {  // repeated until both subscriptions are connected
    EXPECT_TRUE(ros::service::call(plain + topics::kReset, call));
    return !image.messages.empty() && !view.messages.empty();
  }));
  EXPECT_EQ(view.messages[0].data, image.messages[0].data);
  EXPECT_EQ(view.messages[0].width, 51U);
  EXPECT_EQ(view.messages[0].header.frame_id, "camera");
  EXPECT_EQ(image.messages[0].header.frame_id, "camera");
}

}  // namespace
}  // namespace ddm
