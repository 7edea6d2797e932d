// experiment_node: Algorithm 1 with the real nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include <cv_bridge/cv_bridge.h>
#include <ddm_msgs/topics.h>
#include <ddm_node/node_params.h>
#include <ddm_params/param_reader.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "configuration.h"
#include "experiment.h"
#include "learning_curve_image.h"
#include "leave.h"
#include "ros_driver.h"
#include "start.h"

namespace {

/// Shows the learning curve as it is now, to whoever looks and to whoever comes.
void publishCurve(const ros::Publisher& publisher, const std::vector<ddm::TrialRow>& rows,
                  const ddm::Configuration& configuration) {
  const int frames = (configuration.experiment.trials + 1) * configuration.trial.num_steps;
  cv_bridge::CvImage image;
  image.header.stamp = ros::Time::now();
  image.encoding = sensor_msgs::image_encodings::RGB8;
  image.image =
      ddm::drawLearningCurve(rows, static_cast<std::uint32_t>(frames), configuration.evaluation);
  publisher.publish(image.toImageMsg());
}

/// What it has of ROS: outlives the error that ends it.
struct Node {
  ros::NodeHandle nh;
  ros::NodeHandle pnh{"~"};
  ros::Publisher curve_pub;
  std::optional<ddm::RosDriver> driver;
};

void run(Node* node) {
  const ros::NodeHandle& pnh = node->pnh;
  ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
  ddm::Configuration configuration = ddm::readConfiguration(&params);
  if (configuration.experiment.method != "ddm") {
    throw std::invalid_argument("experiment/method must be ddm where the nodes act, got " +
                                configuration.experiment.method + ": use run_experiment");
  }
  ddm::requireLearnedPrediction(configuration.model.training);
  ddm::prepareStart(&configuration);
  ddm::RunFolder folder(configuration);
  ddm::Progress progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, configuration.experiment.trials,
                         configuration.evaluation.error_unit);
  for (const std::string& warning : folder.warnings()) progress.note("warning: " + warning);
  node->curve_pub =
      node->nh.advertise<sensor_msgs::Image>(ddm::topics::kLearningCurveImage, 1, /*latch=*/true);
  ddm::RosDriver::Peers peers;
  if (configuration.robot) peers.reset_timeout = configuration.robot->reset_timeout;
  node->driver.emplace(node->nh, configuration.experiment.timeout, peers);
  ddm::runExperiment(configuration, &*node->driver, &folder, &progress,
                     [&](const std::vector<ddm::TrialRow>& rows) {
                       publishCurve(node->curve_pub, rows, configuration);
                     });
  progress.note("The experiment is finished. roslaunch ends the nodes, and says so in red.");
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "experiment_node");
  Node node;  // outside the try: its destructor shuts the log down
  int code = EXIT_SUCCESS;
  try {
    run(&node);
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("experiment: " << e.what());
    code = EXIT_FAILURE;
  }
  ddm::leaveWithin10s(code);
  return code;
}
