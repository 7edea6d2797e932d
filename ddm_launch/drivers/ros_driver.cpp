// Driver that runs trials and trainings through the services and actions of ROS nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include "ros_driver.h"

#include <ddm_bag_io/model_message.h>
#include <ddm_common/topic_peers.h>
#include <ddm_common/waiting.h>
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <ddm_msgs/topics.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "start.h"

namespace ddm {
namespace {

constexpr std::uint32_t kThreads = 2;
constexpr char kBagUnderWay[] = "";             // StartRecording: continue with the open bag
constexpr std::chrono::milliseconds kLook(20);  // period for conditions without a callback
constexpr char kCancelled[] =
    "was cancelled, as it is when the motors of a robot are stopped in a trial: the same command "
    "resumes";
constexpr char kClockSetBack[] =
    "takes no goal with an earlier stamp than its last one, and the clock was set back: start the "
    "nodes again; the same command resumes";

/// Node handle for the action clients, whose callbacks go to `queue`.
ros::NodeHandle withQueue(ros::NodeHandle nh, ros::CallbackQueue* queue, double limit) {
  waitForSimulatedTime(limit);
  nh.setCallbackQueue(queue);
  return nh;
}

/// Resolved names of the topics between the nodes of the control loop.
std::vector<std::string> loopTopics(const ros::NodeHandle& nh) {
  std::vector<std::string> names;
  for (const char* topic : {topics::kImage, topics::kTorque, topics::kAppliedTorque,
                            topics::kGoalImage, topics::kModel, topics::kGroundTruth}) {
    names.push_back(nh.resolveName(topic));
  }
  return names;
}

}  // namespace

RosDriver::RosDriver(const ros::NodeHandle& nh, double timeout, Peers peers)
    : nh_(withQueue(nh, &callbacks_, timeout)),
      timeout_(timeout),
      peers_(peers),
      trial_client_(nh_, topics::kRunTrial, /*spin_thread=*/false),
      train_client_(nh_, topics::kTrain, /*spin_thread=*/false),
      spinner_(kThreads, &callbacks_) {
  ros::NodeHandle quiet_nh(nh_);
  quiet_nh.setCallbackQueue(&ground_truth_queue_);
  // The queue has no limit, because a progress callback may block the thread that empties it.
  ground_truth_sub_ = quiet_nh.subscribe<sensor_msgs::JointState>(
      topics::kGroundTruth, 0, [this](const sensor_msgs::JointStateConstPtr& state) {
        if (keeps_ground_truth_) ground_truth_[state->header.stamp] = *state;
      });
  // The spinner starts after the action clients are complete. An incomplete client drops the first
  // status of its server, and while simulated time stands still, the server sends no second one.
  spinner_.start();
  connect();
}

void RosDriver::connect() {
  signOfLife();
  const auto service = [this](const char* topic) {
    const std::string name = nh_.resolveName(topic);
    const auto exists = [name] { return ros::service::exists(name, /*print_failure=*/false); };
    waitFor([&] { return answerWithin(timeout_, exists).value_or(false); },
            [&] { return "service " + name + " is not offered"; });
  };
  const auto action = [this](const auto& client, const char* topic) {
    waitFor([&] { return client.isServerConnected(); },
            [&] { return "action " + nh_.resolveName(topic) + " is not offered"; });
  };
  service(topics::kReset);
  if (peers_.recorder) service(topics::kStartRecording);
  action(trial_client_, topics::kRunTrial);
  if (peers_.trainer) action(train_client_, topics::kTrain);
  std::vector<std::string> missing;
  const auto connected = [&] { return (missing = missingConnections(loopTopics(nh_))).empty(); };
  waitFor(connected, [&] {
    return "nodes do not find each other: check ROS_HOSTNAME or ROS_IP on each machine, and run "
           "`rosnode cleanup` if a node has died\n - " +
           boost::algorithm::join(missing, "\n - ");
  });
  // Before a process logs its first line, roscpp reads a parameter from the master. If the master
  // has been stopped by then, the process cannot log the reason. This line makes roscpp read it
  // now.
  ROS_INFO("all nodes are there and connected");
}

void RosDriver::signOfLife() {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_sign_of_life_ = ros::SteadyTime::now();
}

/// Waits for a condition, which is checked after each callback that changed something.
/// @param what  describes what is missing; called without the lock, as it may call the master
/// @throws std::runtime_error on shutdown, or if no message or progress came within the timeout
void RosDriver::waitFor(const std::function<bool()>& condition,
                        const std::function<std::string()>& what) {
  for (;;) {
    ground_truth_queue_.callAvailable();
    if (condition()) return;
    if (!ros::ok()) throw std::runtime_error(kInterrupted);
    std::unique_lock<std::mutex> lock(mutex_);
    if ((ros::SteadyTime::now() - last_sign_of_life_).toSec() > timeout_) {
      lock.unlock();
      throw std::runtime_error(what() + waited(timeout_));
    }
    changed_.wait_for(lock, kLook);
  }
}

template <class Service>
void RosDriver::call(const char* topic, Service* service, double limit) {
  callService(nh_.resolveName(topic), &service_clients_[topic], service, limit);
  signOfLife();
}

/// Sends a goal and waits for its result. Each feedback restarts the timeout.
/// @param fraction_of  maps a feedback to the fraction that is done
template <class Client, class Goal, class FractionOf>
auto RosDriver::execute(Client* client, const std::string& name, const Goal& goal,
                        const FractionOf& fraction_of, const PhaseCallback& progress) {
  // Callbacks may run after this function has returned. The shared pointer keeps their data alive.
  struct Pending {
    bool done = false;
    std::optional<double> fraction;  // latest progress that has not been reported yet
  };
  const auto pending = std::make_shared<Pending>();
  const auto on_done = [this, pending](const actionlib::SimpleClientGoalState&, const auto&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    pending->done = true;
    changed_.notify_all();
  };
  const auto on_feedback = [this, pending, fraction_of](const auto& feedback) {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_sign_of_life_ = ros::SteadyTime::now();
    pending->fraction = fraction_of(*feedback);
    changed_.notify_all();
  };
  // Progress is reported without the lock, because writing to a terminal may block.
  const auto is_done = [&] {
    std::unique_lock<std::mutex> lock(mutex_);
    const bool done = pending->done;
    const std::optional<double> fraction = std::exchange(pending->fraction, std::nullopt);
    lock.unlock();
    if (fraction) progress(*fraction);
    return done;
  };
  signOfLife();
  // The client registers its goal only when sendGoal() returns. It would ignore an earlier answer,
  // and it would report an earlier result as a lost goal. No callback may run until then.
  spinner_.stop();
  client->sendGoal(goal, on_done, typename Client::SimpleActiveCallback(), on_feedback);
  spinner_.start();
  try {
    waitFor(is_done, [&] { return "action " + name + " shows no sign of life"; });
  } catch (const std::exception&) {
    client->cancelGoal();
    throw;
  }
  using State = actionlib::SimpleClientGoalState;
  const State state = client->getState();
  if (state == State::SUCCEEDED) return *client->getResult();
  std::string reason = state.toString() + ", " + state.getText();
  if (state == State::PREEMPTED) reason = kCancelled;
  if (state == State::RECALLED) reason = kClockSetBack;
  throw std::runtime_error("action " + name + ": " + reason);
}

/// Checks that each topic of the control loop has one publisher. A bag does not tell publishers
/// apart, so that messages of a second publisher would corrupt the recording.
/// @throws std::runtime_error naming the topics with several publishers
void RosDriver::refuseIntruders() const {
  std::vector<std::string> names = loopTopics(nh_);
  names.emplace_back("/clock");
  const std::vector<std::string> shared = sharedTopics(names);
  if (shared.empty()) return;
  throw std::runtime_error(
      "the trial is not used, since more than one node may have had a part in it: stop all "
      "publishers but one; the same command resumes\n - " +
      boost::algorithm::join(shared, "\n - "));
}

TrialOutcome RosDriver::runTrial(const TrialRequest& request, const PhaseCallback& progress) {
  // The recording starts before the reset, because the reset may produce the first image at once.
  if (!request.bag.empty()) startRecording(request.bag, last_image_);
  ground_truth_.clear();  // states of an earlier trial that failed
  keeps_ground_truth_ = true;
  const ddm_msgs::Reset::Response begin = reset(request);
  // If the clock has been set back since the last trial, stamps of that trial cannot be compared
  // with those of this one.
  const bool set_back = !begin.start.isZero() && begin.start <= last_image_;
  if (!request.bag.empty() && set_back) startRecording(kBagUnderWay, /*after=*/ros::Time());
  const bool truth_is_due = ground_truth_sub_.getNumPublishers() > 0;
  const ddm_msgs::RunTrialResult result = runPolicy(request, begin, progress);
  last_image_ = result.last;
  refuseIntruders();
  if (!request.bag.empty()) stopRecording(request.num_steps, result.last, begin.goal);

  TrialOutcome outcome;
  const Eigen::Map<const Eigen::MatrixXd> torques(
      result.torque.data(), static_cast<Eigen::Index>(result.torque.size() / result.num_steps),
      static_cast<Eigen::Index>(result.num_steps));
  for (Eigen::Index step = 0; step < torques.cols(); ++step) {
    outcome.torques.emplace_back(torques.col(step));
    outcome.exploratory.push_back(result.exploratory[static_cast<size_t>(step)] != 0);
  }
  outcome.solve_times = result.solve_time;
  outcome.goal_distances = result.goal_distance;
  if (truth_is_due || ground_truth_sub_.getNumPublishers() > 0) {
    takeGroundTruth(result.stamp, &outcome);
  }
  keeps_ground_truth_ = false;
  return outcome;
}

void RosDriver::startRecording(const std::string& bag, const ros::Time& after) {
  ddm_msgs::StartRecording service;
  service.request.path = bag;
  service.request.after = after;
  call(topics::kStartRecording, &service, timeout_);
}

void RosDriver::stopRecording(int num_steps, const ros::Time& last, const ros::Time& goal) {
  ddm_msgs::StopRecording service;
  service.request.num_steps = static_cast<std::uint32_t>(num_steps);
  service.request.last = last;
  service.request.goal = goal;
  call(topics::kStopRecording, &service, timeout_);
  if (service.response.pairs < service.request.num_steps) {
    ROS_WARN("%u of %d images had their torque in time: only these are learned from",
             service.response.pairs, num_steps);
  }
}

ddm_msgs::Reset::Response RosDriver::reset(const TrialRequest& request) {
  ddm_msgs::Reset service;
  service.request.seed = request.id.seed;
  service.request.trial = request.id.trial;
  service.request.evaluation = request.id.evaluation;
  service.request.num_steps = static_cast<std::uint32_t>(request.num_steps);
  call(topics::kReset, &service, timeout_ + peers_.reset_timeout);
  return service.response;
}

ddm_msgs::RunTrialResult RosDriver::runPolicy(const TrialRequest& request,
                                              const ddm_msgs::Reset::Response& begin,
                                              const PhaseCallback& progress) {
  ddm_msgs::RunTrialGoal goal;
  goal.num_steps = static_cast<std::uint32_t>(request.num_steps);
  goal.epsilon = request.epsilon;
  goal.hold_steps = static_cast<std::uint32_t>(request.hold_steps);
  goal.seed = request.id.seed;
  goal.trial = request.id.trial;
  goal.evaluation = request.id.evaluation;
  goal.model_id = request.epsilon < 1.0 ? model_id_ : "";
  goal.start = begin.start;
  goal.goal = begin.goal;
  const ddm_msgs::RunTrialResult result = execute(
      &trial_client_, nh_.resolveName(topics::kRunTrial), goal,
      [num_steps = request.num_steps](const ddm_msgs::RunTrialFeedback& feedback) {
        return static_cast<double>(feedback.step) / num_steps;
      },
      progress);
  if (result.num_steps != goal.num_steps || result.exploratory.size() != result.num_steps ||
      result.stamp.size() != result.num_steps || result.torque.size() % result.num_steps != 0) {
    throw std::runtime_error("action " + nh_.resolveName(topics::kRunTrial) +
                             ": its result is not that of the trial");
  }
  return result;
}

/// Stores the true state at each image that was answered. In real time, there are more states than
/// images. Throws if the simulator has stopped since the trial began, because the success of the
/// trial could not be determined.
void RosDriver::takeGroundTruth(const std::vector<ros::Time>& stamps, TrialOutcome* outcome) {
  const auto is_known = [this](const ros::Time& stamp) { return ground_truth_.count(stamp) > 0; };
  waitFor([&] { return std::all_of(stamps.begin(), stamps.end(), is_known); },
          [&] {
            return "ground truth of the trial is incomplete, " +
                   describePublishers(ground_truth_sub_.getTopic());
          });
  for (const ros::Time& stamp : stamps) {
    const sensor_msgs::JointState& joints = ground_truth_[stamp];
    std::vector<double> values = joints.position;
    values.insert(values.end(), joints.velocity.begin(), joints.velocity.end());
    outcome->times.push_back((stamp - stamps.front()).toSec());
    outcome->states.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  }
}

TrainingOutcome RosDriver::train(const std::vector<std::string>& bags, const TrialId& id,
                                 const PhaseCallback& progress) {
  ddm_msgs::TrainGoal goal;
  goal.bags = bags;
  goal.seed = id.seed;
  goal.trial = id.trial;
  const ddm_msgs::TrainResult result = execute(
      &train_client_, nh_.resolveName(topics::kTrain), goal,
      [](const ddm_msgs::TrainFeedback& feedback) { return feedback.fraction_done; }, progress);
  const ddm_msgs::Model& model = result.model;
  model_id_ = model.id;
  model_pub_.shutdown();  // the publisher is latched: later subscribers must not get the old model
  TrainingOutcome outcome;
  outcome.files["model.ddm"] = std::string(model.data.begin(), model.data.end());
  outcome.frames = model.frames;
  outcome.v_r = model.v_r;
  outcome.v_p = model.v_p;
  outcome.seconds = result.train_time;
  outcome.evaluations = result.evaluations;
  return outcome;
}

bool RosDriver::useModel(const std::string& path) {
  const ddm_msgs::Model model = toMessage(*readModel(path), ros::Time::now());
  model_pub_ = nh_.advertise<ddm_msgs::Model>(topics::kModel, 1, /*latch=*/true);
  model_pub_.publish(model);
  model_id_ = model.id;
  return true;
}

}  // namespace ddm
