// stand_in_camera: a robot made of a simulated plant, with a camera that does not fit and motors.
// SPDX-License-Identifier: BSD-3-Clause
#include <cv_bridge/cv_bridge.h>
#include <ddm_msgs/Reset.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_srvs/Trigger.h>

#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace ddm {
namespace {

constexpr int kQueue = 10;
constexpr int kWidth = 640;
constexpr int kHeight = 480;
const cv::Rect kView(150, 40, 400, 400);     // where the plant is in the picture [pixels]
const cv::Scalar kOffset(40.0, 55.0, 70.0);  // what black looks like, in red, green and blue
constexpr double kNoise = 25.0;              // standard deviation in each channel of each pixel
constexpr int kNumNoises = 16;               // pictures of noise to draw from

/// In the namespace `plant` a simulator in real time, on the other side what robot.launch expects
/// of a robot. The picture has the plant out of its middle, an offset and noise; a frame is as late
/// as the simulator's camera makes it.
class StandInCamera {
 public:
  explicit StandInCamera(ros::NodeHandle nh)
      : transport_(nh), camera_pub_(transport_.advertise("stand_in/image_raw", kQueue)) {
    for (int i = 0; i < kNumNoises; ++i) {
      cv::Mat noise(kHeight, kWidth, CV_16SC3);
      random_.fill(noise, cv::RNG::NORMAL, 0.0, kNoise);
      noises_.push_back(noise);
    }
    ros::NodeHandle plant(nh, "plant");
    torque_pub_ = plant.advertise<ddm_msgs::Torque>(topics::kTorque, kQueue);
    reset_client_ = plant.serviceClient<ddm_msgs::Reset>(topics::kReset, /*persistent=*/false);
    effort_sub_ = nh.subscribe(topics::kEffortCommand, kQueue, &StandInCamera::onEffort, this,
                               ros::TransportHints().tcpNoDelay());
    group_effort_sub_ =
        nh.subscribe(topics::kGroupEffortCommand, kQueue, &StandInCamera::onGroupEffort, this,
                     ros::TransportHints().tcpNoDelay());
    image_sub_ = plant.subscribe(topics::kImage, 1, &StandInCamera::onImage, this,
                                 ros::TransportHints().tcpNoDelay());
    start_server_ = nh.advertiseService("bring_to_start", &StandInCamera::onBringToStart, this);
  }

 private:
  void onImage(const sensor_msgs::ImageConstPtr& image) {
    const cv::Mat plant = cv_bridge::toCvShare(image, sensor_msgs::image_encodings::MONO8)->image;
    cv::Mat view;
    cv::resize(plant, view, kView.size(), 0.0, 0.0, cv::INTER_LINEAR);
    cv::cvtColor(view, view, cv::COLOR_GRAY2RGB);
    cv_bridge::CvImage picture(image->header, sensor_msgs::image_encodings::RGB8);
    picture.image = cv::Mat::zeros(kHeight, kWidth, CV_8UC3);
    view.copyTo(picture.image(kView));
    cv::add(picture.image, kOffset, picture.image);
    const cv::Mat& noise = noises_[static_cast<std::size_t>(random_.uniform(0, kNumNoises))];
    cv::add(picture.image, noise, picture.image, cv::noArray(), CV_8U);
    camera_pub_.publish(picture.toImageMsg());
  }

  void onEffort(const std_msgs::Float64& effort) { move({effort.data}); }
  void onGroupEffort(const std_msgs::Float64MultiArray& efforts) { move(efforts.data); }

  void move(const std::vector<double>& efforts) {
    ddm_msgs::Torque torque;
    torque.header.stamp = ros::Time::now();
    torque.torque = efforts;
    torque_pub_.publish(torque);
  }

  bool onBringToStart(std_srvs::Trigger::Request& /*request*/,
                      std_srvs::Trigger::Response& response) {
    ddm_msgs::Reset reset;
    reset.request.trial = num_starts_++;
    response.success = reset_client_.call(reset) && reset.response.success;
    response.message = reset.response.message;
    return true;
  }

  cv::RNG random_{1};
  std::vector<cv::Mat> noises_;
  std::uint32_t num_starts_ = 0;
  image_transport::ImageTransport transport_;
  image_transport::Publisher camera_pub_;
  ros::Publisher torque_pub_;
  ros::ServiceClient reset_client_;
  ros::Subscriber effort_sub_;        // one motor ...
  ros::Subscriber group_effort_sub_;  // ... or several
  ros::Subscriber image_sub_;
  ros::ServiceServer start_server_;
};

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "stand_in_camera");
  ros::NodeHandle nh;
  ddm::StandInCamera camera(nh);
  ros::spin();
  return EXIT_SUCCESS;
}
