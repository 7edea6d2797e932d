// speed_growth: computing time and memory of learning from so many frames of so many pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_writer.h>
#include <ddm_images/image_codec.h>
#include <ddm_model/objective.h>
#include <ddm_model/pca.h>
#include <ddm_mpc/epsilon_greedy.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <ddm_sim/pendulum.h>
#include <ddm_sim/rig.h>
#include <ros/time.h>
#include <sys/resource.h>

#include <chrono>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "closed_loop.h"
#include "evaluation.h"

namespace ddm {
namespace {

constexpr int kTrialSteps = 1000;
constexpr int kEvaluations = 20;

constexpr char kAbout[] =
    "Prints a row of growth.csv: what PCA and one objective with its gradient take on the frames "
    "of "
    "random trials of the pendulum, preset paper.\n\n"
    "usage: rosrun ddm_launch speed_growth --frames 1600 --size 51";

struct GrowthArguments {
  int frames = 1600;
  int size = 51;
  std::string bags;
};

double microseconds(const std::function<void()>& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}

/// One trial of random torques.
DataSet randomTrial(int num_frames, int trial, int image_size) {
  PendulumOptions options;
  options.picture_size = image_size;
  Rig rig(std::make_unique<Pendulum>(options), CameraOptions());
  TrialId id;
  id.trial = static_cast<std::uint32_t>(trial);
  EpsilonGreedy::Options exploration;
  exploration.epsilon = 1.0;
  exploration.max_torque = rig.plant().info().max_torque;
  EpsilonGreedy policy(nullptr, exploration, id);
  DataSet data(image_size, rig.plant().torqueDim());
  runClosedLoop(&rig, &policy, id, image_size, num_frames, [&data](const ClosedLoopFrame& frame) {
    data.append(frame.grey, frame.decision.torque, frame.index == 0);
  });
  data.setGoal(rig.goalImage().bytes);
  return data;
}

void writeBag(const DataSet& trial, const std::string& path) {
  BagWriter bag(path, BagOptions());
  const auto stampOf = [](Eigen::Index frame) {
    return ros::Time(1, 0) + ros::Duration(0.2 * static_cast<double>(frame));
  };
  const auto message = [&trial](const Grey& grey, const ros::Time& stamp) {
    return encodeImage(grey, trial.imageSize(), stamp, "camera");
  };
  bag.writeGoal(message(trial.goal(), stampOf(0)), stampOf(0));
  for (Eigen::Index frame = 0; frame < trial.numFrames(); ++frame) {
    bag.write(message(trial.image(frame), stampOf(frame)));
    ddm_msgs::Torque torque;
    torque.header.stamp = stampOf(frame);
    torque.torque = {trial.torques()(0, frame)};
    bag.write(torque);
  }
  bag.close();
}

void run(const GrowthArguments& arguments) {
  DataSet data(arguments.size, 1);
  for (int begin = 0, trial = 0; begin < arguments.frames; begin += kTrialSteps, ++trial) {
    const int num_frames = std::min(kTrialSteps, arguments.frames - begin);
    const DataSet one = randomTrial(num_frames, trial, arguments.size);
    if (!arguments.bags.empty()) {
      writeBag(one, arguments.bags + "/" + std::to_string(trial) + ".bag");
    }
    data.append(one);
  }
  const ModelOptions model;
  Pca pca;
  const double pca_us = microseconds([&] { pca = fitPca(data, model.pca_dim); });
  const Networks<float> networks(model, data.torqueDim());
  JointObjective<float> objective(networks, makeTrainingData(data, pca));
  const Eigen::VectorXf theta = Eigen::VectorXf::Constant(networks.numParams(), 0.05F);
  Eigen::VectorXf d_theta;
  std::vector<double> times;
  for (int i = 0; i <= kEvaluations; ++i) {
    const double time = microseconds([&] { objective.evaluate(theta, &d_theta); });
    if (i > 0) times.push_back(time);  // memory is taken in the first
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::cout << arguments.frames << "," << arguments.size << "," << formatDouble(pca_us) << ","
            << formatDouble(quantile(times, 0.5)) << ","
            << formatDouble(static_cast<double>(usage.ru_maxrss) / 1024.0) << "\n";
}

bool parse(int argc, char** argv, GrowthArguments* arguments) {
  namespace po = boost::program_options;
  po::options_description options(std::string(kAbout) + "\n\noptions");
  options.add_options()("frames", po::value<int>(&arguments->frames)->default_value(1600),
                        "frames to learn from");
  options.add_options()("size", po::value<int>(&arguments->size)->default_value(51),
                        "width and height of the image [pixels]");
  options.add_options()("bags", po::value<std::string>(&arguments->bags),
                        "existing folder to write the trials to, 1000 frames a bag");
  if (!parseCommandLine(argc, argv, options)) return false;
  if (arguments->frames < 100 || arguments->size < 8) {
    throw std::invalid_argument("--frames must be >= 100 and --size >= 8");
  }
  return true;
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::GrowthArguments arguments;
  return ddm::runTool(
      "speed_growth", [&] { return ddm::parse(argc, argv, &arguments); },
      [&] { ddm::run(arguments); });
}
