// replay_node: plays a bag to mpc_node and compares what it proposes with what was recorded.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib/client/simple_action_client.h>
#include <ddm_bag_io/bag_reader.h>
#include <ddm_bag_io/model_message.h>
#include <ddm_files/plain_file.h>
#include <ddm_images/image_codec.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ddm_node/node_params.h>
#include <ddm_params/param_reader.h>
#include <ddm_params/param_value.h>
#include <ros/ros.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include "connections.h"
#include "csv_text.h"
#include "progress.h"
#include "simulated_time.h"

namespace {

constexpr char kRecorded[] = "replay/torque";
constexpr char kProposed[] = "replay/proposed_torque";
const ros::WallDuration kLook(0.02);  // how often conditions without a callback are looked at

/// Block `replay`.
struct ReplayOptions {
  std::string bag;        ///< bag to play
  std::string model;      ///< model file
  std::string out;        ///< CSV file of both torques; empty: none
  double rate = 1.0;      ///< speed in terms of that of the recording [-]; 0: as fast as plans come
  double timeout = 10.0;  ///< wall time that an answer may take [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("bag", bag);
    visitor("model", model);
    visitor("out", out);
    visitor("rate", rate);
    visitor("timeout", timeout);
  }
  std::vector<std::string> problems() const {
    std::vector<std::string> out_problems;
    const auto require = [&out_problems](bool ok, const std::string& rule, double value) {
      if (!ok) out_problems.push_back("replay/" + rule + ", got " + std::to_string(value));
    };
    if (bag.empty()) out_problems.push_back("replay/bag must be a bag, got nothing");
    if (model.empty()) out_problems.push_back("replay/model must be a model file, got nothing");
    require(rate >= 0.0 && rate <= 1000.0, "rate must lie in [0, 1000]", rate);
    require(timeout > 0.0 && timeout <= 3600.0, "timeout must lie in (0, 3600]", timeout);
    return out_problems;
  }
};

/// Gives mpc_node one image after the other and takes its answers. Moves no motor: it publishes
/// below `replay/`, and mpc_node's own topics are remapped there.
class Replay {
 public:
  Replay(ros::NodeHandle nh, const ReplayOptions& options, const ddm::Ddm& model)
      : options_(options),
        trial_client_(nh, ddm::topics::kRunTrial, /*spin_thread=*/false),
        image_pub_(nh.advertise<sensor_msgs::Image>(ddm::topics::kImage, 1)),
        model_pub_(nh.advertise<ddm_msgs::Model>(ddm::topics::kModel, 1, /*latch=*/true)),
        recorded_pub_(nh.advertise<ddm_msgs::Torque>(kRecorded, 1)),
        proposed_sub_(nh.subscribe(kProposed, 1, &Replay::onProposed, this)) {
    const ddm_msgs::Model message = ddm::toMessage(model, ros::Time::now());
    model_id_ = message.id;
    model_pub_.publish(message);
    waitFor([this] { return trial_client_.isServerConnected(); },
            "action " + nh.resolveName(ddm::topics::kRunTrial) + " is not offered");
    const std::vector<std::string> topics = {nh.resolveName(ddm::topics::kImage),
                                             nh.resolveName(kProposed)};
    waitFor(
        [&] {
          return image_pub_.getNumSubscribers() > 0 && proposed_sub_.getNumPublishers() > 0 &&
                 ddm::missingConnections(topics).empty();
        },
        "nothing takes " + topics[0] + " and answers on " + topics[1]);
  }

  /// One stretch of frames without a gap: a trial of its own.
  void beginPiece(Eigen::Index num_frames) {
    ddm_msgs::RunTrialGoal goal;
    goal.num_steps = static_cast<std::uint32_t>(num_frames);
    goal.hold_steps = 1;
    goal.evaluation = 1;  // greedy
    goal.model_id = model_id_;
    goal.start = ros::Time::now();
    trial_client_.sendGoal(goal);
    trial_begun_ = true;
  }

  /// @return the torque that mpc_node proposes for an image
  Eigen::VectorXd propose(const ddm::Grey& grey, int size, const Eigen::VectorXd& recorded) {
    const ros::Time stamp = ros::Time::now();
    ddm_msgs::Torque torque;
    torque.header.stamp = stamp;
    torque.torque.assign(recorded.data(), recorded.data() + recorded.size());
    image_pub_.publish(ddm::encodeImage(grey, size, stamp, "camera"));
    recorded_pub_.publish(torque);
    waitFor(
        [this, stamp] {
          const std::lock_guard<std::mutex> lock(mutex_);
          return answer_ && answer_->header.stamp == stamp;
        },
        "mpc_node does not answer");
    const std::lock_guard<std::mutex> lock(mutex_);
    return Eigen::Map<const Eigen::VectorXd>(answer_->torque.data(),
                                             static_cast<Eigen::Index>(answer_->torque.size()));
  }

 private:
  void onProposed(const ddm_msgs::TorqueConstPtr& torque) {
    const std::lock_guard<std::mutex> lock(mutex_);
    answer_ = *torque;
    changed_.notify_all();
  }

  /// @throws std::runtime_error after the timeout, if mpc_node gives the trial up, or on shutdown
  template <class Condition>
  void waitFor(const Condition& condition, const std::string& what) {
    const ros::WallTime begin = ros::WallTime::now();
    while (!condition()) {
      if (!ros::ok()) throw std::runtime_error("interrupted");
      if (trial_begun_ && trial_client_.getState() == actionlib::SimpleClientGoalState::ABORTED) {
        throw std::runtime_error("mpc_node: " + trial_client_.getState().getText());
      }
      if ((ros::WallTime::now() - begin).toSec() > options_.timeout) {
        throw std::runtime_error(what + " (waited " + std::to_string(options_.timeout) + " s)");
      }
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait_for(lock, std::chrono::nanoseconds(kLook.toNSec()));
    }
  }

  const ReplayOptions& options_;
  std::mutex mutex_;  // guards answer_
  std::condition_variable changed_;
  std::optional<ddm_msgs::Torque> answer_;
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

std::string columns(const std::string& name, int count) {
  std::string text;
  for (int i = 1; i <= count; ++i) text += "," + name + "_" + std::to_string(i);
  return text;
}

/// Plays all frames.
/// @return proposed torques [N m]  [torque_dim x N]
Eigen::MatrixXd play(const ddm::BagContent& bag, double rate, Replay* replay,
                     ddm::Progress* progress) {
  const ddm::DataSet& data = bag.data;
  Eigen::MatrixXd proposed(data.torqueDim(), data.numFrames());
  const ros::WallTime begin = ros::WallTime::now();
  for (const ddm::Piece& piece : data.pieces()) {
    replay->beginPiece(piece.size);
    for (Eigen::Index frame = piece.begin; frame < piece.begin + piece.size; ++frame) {
      const double time = bag.times[static_cast<size_t>(frame)];
      if (rate > 0.0) ros::WallTime::sleepUntil(begin + ros::WallDuration(time / rate));
      const Eigen::VectorXd torque =
          replay->propose(data.image(frame), data.imageSize(), data.torques().col(frame));
      if (torque.size() != proposed.rows()) {
        throw std::runtime_error("the model has " + std::to_string(torque.size()) +
                                 " torque(s), the bag " + std::to_string(proposed.rows()) +
                                 ": they are of different robots");
      }
      proposed.col(frame) = torque;
      progress->update(static_cast<double>(frame + 1) / static_cast<double>(data.numFrames()));
    }
  }
  return proposed;
}

void writeCsv(const ddm::BagContent& bag, const Eigen::MatrixXd& proposed,
              const std::string& path) {
  const ddm::DataSet& data = bag.data;
  std::string text = "frame,piece,time_s" + columns("recorded", data.torqueDim()) +
                     columns("proposed", data.torqueDim()) + "\n";
  for (size_t p = 0; p < data.pieces().size(); ++p) {
    const ddm::Piece& piece = data.pieces()[p];
    for (Eigen::Index frame = piece.begin; frame < piece.begin + piece.size; ++frame) {
      text += std::to_string(frame) + "," + std::to_string(p) + "," +
              ddm::formatDouble(bag.times[static_cast<size_t>(frame)]) +
              ddm::csvValues(data.torques().col(frame)) + ddm::csvValues(proposed.col(frame)) +
              "\n";
    }
  }
  ddm::writeFileAtomically(path, text);
}

void run(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) {
  ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
  const auto options = params.read<ReplayOptions>("replay");
  const auto topics = params.read<ddm::BagOptions>("data_set");
  params.requireValid();
  const ddm::Ddm model = ddm::deserialiseModel(ddm::readFile(options.model), options.model);
  const ddm::BagContent bag = ddm::readBag(options.bag, model.imageSize(), topics);
  ddm::waitForSimulatedTime(options.timeout);
  Replay replay(nh, options, model);
  ddm::Progress progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, 0);
  progress.beginPhase(0, "replay");
  const Eigen::MatrixXd proposed = play(bag, options.rate, &replay, &progress);
  std::ostringstream summary;
  summary << bag.data.numFrames() << " frames replayed, root mean square torque [N m]: recorded "
          << rms(bag.data.torques()) << ", proposed " << rms(proposed) << ", difference "
          << rms(proposed - bag.data.torques());
  progress.note(summary.str());
  if (options.out.empty()) return;
  writeCsv(bag, proposed, options.out);
  progress.note("both torques: " + options.out);
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "replay_node");
  const ros::NodeHandle nh;
  const ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  ros::AsyncSpinner spinner(2);
  spinner.start();
  try {
    run(nh, pnh);
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("replay: " << e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
