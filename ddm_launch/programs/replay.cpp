// Role `replay` of experiment_node: plays a bag to mpc_node and compares torques with the recording.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib/client/simple_action_client.h>
#include <ddm_bag_io/bag_reader.h>
#include <ddm_bag_io/model_message.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/run_node.h>
#include <ddm_common/topic_peers.h>
#include <ddm_common/waiting.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "progress.h"
#include "start.h"
#include "tables.h"

namespace ddm {
namespace {

constexpr char kRecorded[] = "replay/torque";
constexpr char kProposed[] = "replay/proposed_torque";
const ros::WallDuration kLook(0.02);  // period for conditions without a callback [s]

/// Block `replay`.
struct ReplayOptions {
  std::string bag;        ///< path of the bag to play
  std::string model;      ///< path of the model
  std::string out;        ///< CSV file for both torques; empty: none
  double rate = 1.0;      ///< speed relative to the recording [-]; 0: as fast as plans are computed
  double timeout = 10.0;  ///< longest wall time for an answer [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("bag", bag);
    visitor("model", model);
    visitor("out", out);
    visitor("rate", rate);
    visitor("timeout", timeout);
  }
  std::vector<std::string> problems() const {
    OptionChecks checks("replay");
    checks.require(!bag.empty(), "bag", "be a bag", "nothing");
    checks.require(!model.empty(), "model", "be a model file", "nothing");
    checks.require(rate >= 0.0 && rate <= 1000.0, "rate", "lie in [0, 1000]", rate);
    checks.requireTimeLimit("timeout", timeout);
    return checks.problems();
  }
};

/// Sends one image after the other to mpc_node and receives its torques. No motor can move: this
/// program publishes below `replay/`, and the topics of mpc_node are remapped to `replay/` too.
class Replay {
 public:
  Replay(ros::NodeHandle nh, const ReplayOptions& options, const Ddm& model)
      : options_(options),
        trial_client_(nh, topics::kRunTrial, /*spin_thread=*/false),
        image_pub_(nh.advertise<sensor_msgs::Image>(topics::kImage, 1)),
        model_pub_(nh.advertise<ddm_msgs::Model>(topics::kModel, 1, /*latch=*/true)),
        recorded_pub_(nh.advertise<ddm_msgs::Torque>(kRecorded, 1)),
        proposed_sub_(nh.subscribe<ddm_msgs::Torque>(
            kProposed, 1, [this](const ddm_msgs::TorqueConstPtr& torque) { answer_ = torque; })) {
    const ddm_msgs::Model message = toMessage(model, ros::Time::now());
    model_id_ = message.id;
    model_pub_.publish(message);
    waitFor([this] { return trial_client_.isServerConnected(); },
            "action " + nh.resolveName(topics::kRunTrial) + " is not offered");
    const std::vector<std::string> topics = {nh.resolveName(topics::kImage),
                                             nh.resolveName(kProposed)};
    waitFor(
        [&] {
          return image_pub_.getNumSubscribers() > 0 && proposed_sub_.getNumPublishers() > 0 &&
                 missingConnections(topics).empty();
        },
        "nothing takes " + topics[0] + " and answers on " + topics[1]);
  }

  /// Starts a trial of mpc_node for one segment, i.e. samples without a gap.
  void beginSegment(Eigen::Index num_frames) {
    ddm_msgs::RunTrialGoal goal;
    goal.num_steps = static_cast<std::uint32_t>(num_frames);
    goal.hold_steps = 1;
    goal.evaluation = 1;  // no exploration
    goal.model_id = model_id_;
    goal.start = ros::Time::now();
    trial_client_.sendGoal(goal);
    trial_begun_ = true;
  }

  /// @return the torque that mpc_node computes for an image [N m]
  Eigen::VectorXd propose(const Image& image, int size, const Eigen::VectorXd& recorded) {
    const ros::Time stamp = ros::Time::now();
    ddm_msgs::Torque torque;
    torque.header.stamp = stamp;
    torque.torque.assign(recorded.data(), recorded.data() + recorded.size());
    image_pub_.publish(encodeImage(image, size, stamp, "camera"));
    recorded_pub_.publish(torque);
    waitFor([this, stamp] { return answer_ != nullptr && answer_->header.stamp == stamp; },
            "mpc_node does not answer");
    return Eigen::Map<const Eigen::VectorXd>(answer_->torque.data(),
                                             static_cast<Eigen::Index>(answer_->torque.size()));
  }

  /// Waits until mpc_node has completed a segment. If mpc_node refuses an image, it answers with
  /// torque zero before it aborts the trial, so that only the result of the trial tells this zero
  /// from a computed torque.
  /// @throws std::runtime_error if mpc_node has not completed the trial
  void endSegment() {
    waitFor([this] { return trial_client_.getState().isDone(); },
            "mpc_node does not end its trial");
    const actionlib::SimpleClientGoalState state = trial_client_.getState();
    if (state == actionlib::SimpleClientGoalState::SUCCEEDED) return;
    throw std::runtime_error("mpc_node: " + state.toString() + ", " + state.getText());
  }

 private:
  /// @throws std::runtime_error on shutdown, after the timeout, or if mpc_node aborts the trial
  template <class Condition>
  void waitFor(const Condition& condition, const std::string& what) {
    const ros::SteadyTime begin = ros::SteadyTime::now();
    while (!condition()) {
      if (!ros::ok()) throw std::runtime_error("interrupted");
      if (trial_begun_ && trial_client_.getState() == actionlib::SimpleClientGoalState::ABORTED) {
        throw std::runtime_error("mpc_node: " + trial_client_.getState().getText());
      }
      if ((ros::SteadyTime::now() - begin).toSec() > options_.timeout) {
        throw std::runtime_error(what + waited(options_.timeout));
      }
      ros::getGlobalCallbackQueue()->callAvailable(kLook);
    }
  }

  const ReplayOptions& options_;
  ddm_msgs::TorqueConstPtr answer_;
  std::string model_id_;
  bool trial_begun_ = false;
  actionlib::SimpleActionClient<ddm_msgs::RunTrialAction> trial_client_;
  ros::Publisher image_pub_;
  ros::Publisher model_pub_;
  ros::Publisher recorded_pub_;
  ros::Subscriber proposed_sub_;
};

double rms(const Eigen::MatrixXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Plays all samples of a bag.
/// @param csv  out: the text of the CSV file
/// @return     proposed torques [N m]  [torque_dim x N]
Eigen::MatrixXd play(const BagContent& bag, double rate, Replay* replay, Progress* progress,
                     std::string* csv) {
  const DataSet& data = bag.data;
  Eigen::MatrixXd proposed(data.torqueDim(), data.numFrames());
  *csv = csvLine("frame", "segment", "time_s", featureNames(data.torqueDim(), "recorded"),
                 featureNames(data.torqueDim(), "proposed"));
  const ros::SteadyTime begin = ros::SteadyTime::now();
  for (size_t number = 0; number < data.segments().size(); ++number) {
    const Segment& segment = data.segments()[number];
    replay->beginSegment(segment.size);
    for (Eigen::Index frame = segment.begin; frame < segment.begin + segment.size; ++frame) {
      const double time = bag.times[static_cast<size_t>(frame)];
      if (rate > 0.0) ros::SteadyTime::sleepUntil(begin + ros::WallDuration(time / rate));
      const Eigen::VectorXd recorded = data.torques().col(frame);
      const Eigen::VectorXd torque = replay->propose(data.image(frame), data.imageSize(), recorded);
      if (torque.size() != proposed.rows()) {
        throw std::runtime_error("the model has " + std::to_string(torque.size()) +
                                 " torque(s), the bag " + std::to_string(proposed.rows()) +
                                 ": they are of different robots");
      }
      proposed.col(frame) = torque;
      *csv += csvLine(frame, number, time, recorded, torque);
      progress->update(static_cast<double>(frame + 1) / static_cast<double>(data.numFrames()));
    }
    replay->endSegment();
  }
  return proposed;
}

void run(const ros::NodeHandle& nh, ParamReader* params) {
  const auto options = params->read<ReplayOptions>("replay");
  const auto topics = params->read<BagOptions>("data_set");
  params->requireValid();
  if (!options.out.empty()) requireWritable(options.out);
  const std::shared_ptr<const Ddm> model = readModel(options.model);
  const BagContent bag = readBag(options.bag, model->imageSize(), topics);
  for (const std::string& note : bag.notes) ROS_WARN_STREAM("bag " << options.bag << ": " << note);
  waitForSimulatedTime(options.timeout);
  Replay replay(nh, options, *model);
  Progress progress;
  progress.beginPhase(0, "replay");
  std::string csv;
  const Eigen::MatrixXd proposed = play(bag, options.rate, &replay, &progress, &csv);
  std::ostringstream summary;
  summary << bag.data.numFrames() << " frames replayed, root mean square torque [N m]: recorded "
          << rms(bag.data.torques()) << ", proposed " << rms(proposed) << ", difference "
          << rms(proposed - bag.data.torques());
  progress.note(summary.str());
  if (options.out.empty()) return;
  writeFileAtomically(options.out, csv);
  progress.note("both torques: " + options.out);
}

}  // namespace

int replayNode(int argc, char** argv) {
  return runNode("replay_node", argc, argv,
                 [](auto nh, auto, ParamReader* params) { run(nh, params); });
}

}  // namespace ddm
