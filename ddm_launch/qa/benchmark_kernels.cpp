// benchmark_kernels: times the objective on a finished experiment, or round trips of messages.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_cache.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/tool.h>
#include <ddm_model/networks.h>
#include <ddm_model/objective.h>
#include <ddm_model/schedule.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "ros_driver.h"
#include "run_folder.h"
#include "start.h"

namespace ddm {
namespace {

constexpr int kProductBlocks[] = {32, 64, 128, 256, 512, 1600};
constexpr int kNumCalls = 1000;
constexpr int kImageSize = 51;
constexpr int kQueue = 1000;
constexpr double kTimeout = 30.0;  // [s]

constexpr char kAbout[] =
    "Times the objective and its matrix products on the bags and the last model of a finished\n"
    "experiment, or is one node of a loop and prints the mean time of a round trip [us]:\n\n"
    "  lockstep         lets the real nodes run a random trial, without recorder\n"
    "  bare_camera      publishes an image as soon as the torque for the previous image arrives\n"
    "  bare_controller  answers each image with a torque\n\n"
    "usage: rosrun ddm_launch benchmark_kernels RUN_FOLDER\n"
    "       rosrun ddm_launch benchmark_kernels lockstep|bare_camera|bare_controller NUM_FRAMES\n\n"
    "`rosrun ddm_launch qa benchmark` runs both.\n";

using Clock = std::chrono::steady_clock;
using Microseconds = std::chrono::duration<double, std::micro>;

/// Prints median and 99 % quantile of the time of a call [us].
void measure(const std::string& name, const std::function<void()>& call) {
  std::vector<double> times;
  for (int i = 0; i < kNumCalls; ++i) {
    const Clock::time_point begin = Clock::now();
    call();
    times.push_back(Microseconds(Clock::now() - begin).count());
  }
  std::cout << name << " " << quantile(times, 0.5) << " " << quantile(times, 0.99) << "\n";
}

/// The matrix products W a, delta a^T and W^T delta of each layer of g^-1, g and f, with random
/// matrices. Every implementation of V_R + V_P and its gradient needs these products, so their time
/// is a lower bound. f predicts num_steps features from each image, and the decoder decodes these
/// features and that of the image.
class MatrixProducts {
 public:
  /// @param block  number of samples that go through all networks together
  MatrixProducts(const Networks<float>& networks, Eigen::Index num_samples, int num_steps,
                 Eigen::Index block)
      : num_blocks_((num_samples + block - 1) / block) {
    add(networks.encoder(), block, false);  // the encoder's inputs need no gradient
    add(networks.f(), num_steps * block, true);
    add(networks.decoder(), (1 + num_steps) * block, true);
  }

  void run() {
    for (Eigen::Index block = 0; block < num_blocks_; ++block) {
      for (Layer& layer : layers_) layer.outputs.noalias() = layer.weights * layer.inputs;
      for (Layer& layer : layers_) {
        layer.d_weights.noalias() += layer.d_outputs * layer.inputs.transpose();
        if (!layer.needs_d_inputs) continue;
        layer.d_inputs.noalias() = layer.weights.transpose() * layer.d_outputs;
      }
    }
  }

 private:
  struct Layer {
    Eigen::MatrixXf weights, d_weights;  // [outputs x inputs]
    Eigen::MatrixXf inputs, d_inputs;    // [inputs x samples]
    Eigen::MatrixXf outputs, d_outputs;  // [outputs x samples]
    bool needs_d_inputs = true;
  };

  void add(const Mlp<float>& net, Eigen::Index samples, bool needs_d_inputs) {
    for (size_t l = 1; l < net.widths().size(); ++l) {
      const int inputs = net.widths()[l - 1], outputs = net.widths()[l];
      Layer layer;
      layer.weights = layer.d_weights = Eigen::MatrixXf::Random(outputs, inputs);
      layer.inputs = layer.d_inputs = Eigen::MatrixXf::Random(inputs, samples);
      layer.outputs = layer.d_outputs = Eigen::MatrixXf::Random(outputs, samples);
      layer.needs_d_inputs = needs_d_inputs || l > 1;
      layers_.push_back(std::move(layer));
    }
  }

  Eigen::Index num_blocks_;
  std::vector<Layer> layers_;
};

void timeObjective(const std::string& run) {
  ParamReader reader = ParamReader::fromFiles({run + "/config.yaml"});
  Configuration configuration = readConfiguration(&reader);
  configuration.experiment.runs = run;
  const RunFolder folder(configuration);
  if (folder.rows().empty()) throw std::runtime_error(run + " holds no finished trial");
  const int last = folder.rows().back().trial;
  const ModelConfig& config = configuration.model;
  const DataSet data = BagCache(config.image.size, config.data_set).read(folder.bagsUpTo(last));
  const std::shared_ptr<const Ddm> model = readModel(folder.trainingPath(last) + "/model.ddm");

  const Networks<float> networks(model->options(), data.torqueDim());
  JointObjective<float> objective(networks, makeTrainingData(data, model->pca()));
  const Eigen::VectorXf theta = model->theta().cast<float>();
  Eigen::VectorXf d_theta;
  const Terms terms = makeSchedule(config.training).terms();
  measure("objective_gradient", [&] { objective.evaluate(theta, &d_theta, terms); });
  for (const int block : kProductBlocks) {
    MatrixProducts products(networks, objective.numPredictions(), terms.prediction_steps, block);
    measure("matrix_products/" + std::to_string(block), [&products] { products.run(); });
  }
}

/// Mean time of round trips. Ignores the first kWarmUp round trips, in which connections and caches
/// are new.
class Stopwatch {
 public:
  /// Reports that `number` round trips are complete.
  void tick(int number) {
    if (number < kWarmUp) return;
    last_ = {number, Clock::now()};
    if (first_.first == 0) first_ = last_;
  }

  /// Prints the mean time of a round trip [us].
  /// @throws std::runtime_error if fewer than two round trips have been reported
  void print() const {
    const int number = last_.first - first_.first;
    if (number == 0) throw std::runtime_error("no round trip was timed");
    std::cout << Microseconds(last_.second - first_.second).count() / number << "\n";
  }

 private:
  static constexpr int kWarmUp = 100;

  std::pair<int, Clock::time_point> first_, last_;
};

/// Times the real nodes through the feedback of their trial. Subscribing to each image would add
/// load.
void timeLockstep(const ros::NodeHandle& nh, int num_frames) {
  RosDriver::Peers peers;
  peers.recorder = peers.trainer = false;
  RosDriver driver(nh, kTimeout, peers);
  TrialRequest request;
  request.num_steps = num_frames;
  request.epsilon = 1.0;
  Stopwatch watch;
  driver.runTrial(request, [&](double fraction) {
    watch.tick(static_cast<int>(std::lround(fraction * num_frames)));
  });
  watch.print();
}

void timeBareCamera(ros::NodeHandle* nh, int num_frames) {
  const std::vector<std::uint8_t> grey(kImageSize * kImageSize, 100);
  const ros::Publisher images = nh->advertise<sensor_msgs::Image>(topics::kImage, kQueue);
  ros::Time stamp(1, 0);
  int num_answered = 0;
  Stopwatch watch;
  const auto show = [&] {
    stamp += ros::Duration(0.2);
    images.publish(encodeImage(grey, kImageSize, stamp, "camera"));
  };
  const auto on_torque = [&](const ddm_msgs::TorqueConstPtr& torque) {
    if (torque->header.stamp != stamp) return;
    watch.tick(++num_answered);
    if (num_answered < num_frames) return show();
    ros::shutdown();
  };
  const ros::Subscriber torques = nh->subscribe<ddm_msgs::Torque>(
      topics::kTorque, kQueue, on_torque, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  const ros::WallTimer start = nh->createWallTimer(ros::WallDuration(0.05), [&](const auto&) {
    if (stamp == ros::Time(1, 0) && images.getNumSubscribers() && torques.getNumPublishers())
      show();
  });
  ros::spin();
  watch.print();
}

void answerImages(ros::NodeHandle* nh) {
  const ros::Publisher torques = nh->advertise<ddm_msgs::Torque>(topics::kTorque, kQueue);
  const auto on_image = [&torques](const sensor_msgs::ImageConstPtr& image) {
    ddm_msgs::Torque torque;
    torque.header.stamp = image->header.stamp;
    torque.torque = {1.0};
    torques.publish(torque);
  };
  const ros::Subscriber images = nh->subscribe<sensor_msgs::Image>(
      topics::kImage, kQueue, on_image, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
}

void run(int argc, char** argv) {
  const std::string what = argv[1];
  if (what != "lockstep" && what != "bare_camera" && what != "bare_controller") {
    ros::Time::init();
    return timeObjective(what);
  }
  ros::init(argc, argv, what);
  ros::NodeHandle nh;
  if (what == "bare_controller") return answerImages(&nh);
  const int num_frames = argc > 2 ? std::stoi(argv[2]) : 3000;
  if (what == "lockstep") return timeLockstep(nh, num_frames);
  timeBareCamera(&nh, num_frames);
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') {
    std::cout << ddm::kAbout;
    return argc < 2 ? ddm::kUsageError : EXIT_SUCCESS;
  }
  try {
    ddm::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "benchmark_kernels: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
