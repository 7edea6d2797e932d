// Role `experiment` of experiment_node: runs Algorithm 1 with ROS nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/run_node.h>
#include <ddm_msgs/topics.h>
#include <std_msgs/String.h>

#include <cstdint>
#include <optional>
#include <stdexcept>

#include "algorithm1.h"
#include "configuration.h"
#include "ros_driver.h"
#include "start.h"
#include "tables.h"

namespace ddm {
namespace {

/// Publishes the rows of all trials on a latched topic, which learning_curve_node draws.
void publishTrials(const ros::Publisher& publisher, const std::vector<TrialRow>& rows,
                   const Configuration& configuration) {
  YAML::Node trials;
  trials["goal"] = toYaml(configuration)["goal"];
  trials["frames"] = static_cast<std::int64_t>(configuration.experiment.trials + 1) *
                     configuration.trial.num_steps * configuration.trial.episodes;
  trials["trials_csv"] = formatTrialsCsv(rows);
  std_msgs::String message;
  message.data = YAML::Dump(trials);
  publisher.publish(message);
}

/// Objects that must outlive an error message, because their destructors wait for the ROS master.
struct Node {
  ros::Publisher trials_pub;
  std::optional<RosDriver> driver;
};

void run(ros::NodeHandle nh, ParamReader* params, Node* node) {
  Configuration configuration = readConfiguration(params);
  if (configuration.experiment.method != "ddm") {
    throw std::invalid_argument("experiment/method must be ddm where the nodes act, got " +
                                configuration.experiment.method + ": use run_experiment");
  }
  requireLearnedPrediction(configuration.model.training);
  prepareStart(&configuration);
  RunFolder folder(configuration);
  Progress progress(configuration.experiment.trials, configuration.plant_info.error_unit);
  node->trials_pub = nh.advertise<std_msgs::String>(topics::kTrials, 1, /*latch=*/true);
  RosDriver::Peers peers;
  if (configuration.robot) peers.reset_timeout = configuration.robot->reset_timeout;
  node->driver.emplace(nh, configuration.experiment.timeout, peers);
  runExperiment(configuration, &*node->driver, &folder, &progress,
                [&](const std::vector<TrialRow>& rows) {
                  publishTrials(node->trials_pub, rows, configuration);
                });
  progress.note("The experiment is finished. roslaunch ends the nodes, and says so in red.");
}

}  // namespace

int experimentNode(int argc, char** argv) {
  Node node;
  return runNode("experiment_node", argc, argv,
                 [&node](auto nh, auto, ParamReader* params) { run(nh, params, &node); });
}

}  // namespace ddm
