// train_from_bags: trains a model from bags like model_node, but without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/plain_file.h>
#include <ddm_model/minimise.h>
#include <ddm_model/model_file.h>
#include <ddm_model/per_motor.h>
#include <ddm_model/trainer.h>
#include <ros/time.h>
#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "bag_arguments.h"

namespace po = boost::program_options;

namespace {

struct Arguments : ddm::BagArguments {
  std::vector<std::string> values;
  std::string goal;
  std::int64_t seed = 0;  // signed, so that -1 is refused instead of read as a huge number
};

/// @return false if --help was given and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(
      "Trains a deep dynamical model from recorded bags, without a ROS master.\n\n"
      "usage: rosrun ddm_model train_from_bags [--config FILE]... [--goal IMAGE] [--seed N]\n"
      "                                        --out FILE BAG...\n\n"
      "The blocks image, model, training and data_set count. The limits of the motors are\n"
      "model/max_torque, else those of a block robot or plant.\n\noptions",
      100);
  options.add_options()("set", po::value(&arguments->values)->composing(),
                        "BLOCK/KEY=VALUE, wins over all files; a list is [A, B]; repeatable");
  options.add_options()("goal", po::value(&arguments->goal),
                        "goal image, cropped like theirs; else the goal_image of the last bag that "
                        "has one");
  options.add_options()("seed", po::value(&arguments->seed)->default_value(0),
                        "seed of the initial parameters");
  if (!arguments->parse(argc, argv, options)) return false;
  if (arguments->seed < 0) {
    throw po::error("--seed must be >= 0, got " + std::to_string(arguments->seed));
  }
  return true;
}

bool showProgress(const ddm::TrainingProgress& progress) {
  if (::isatty(STDERR_FILENO) != 0 && progress.iteration % 10 == 0) {
    std::cerr << "\riteration " << progress.iteration << "  V_R " << progress.v_r << "  V_P "
              << progress.v_p << "        " << std::flush;
  }
  return true;
}

void run(const Arguments& arguments) {
  YAML::Node blocks = arguments.blocks();
  for (const std::string& value : arguments.values) ddm::setValue(value, &blocks);
  const std::string limits_from = ddm::takeOverLimits("model", &blocks);
  ddm::ParamReader params(blocks, arguments.files());
  const ddm::ModelConfig config = ddm::readModelConfig(&params);
  params.requireValid();
  ddm::requireWritable(arguments.out);
  ddm::Image goal;  // empty: none is given
  if (!arguments.goal.empty()) {
    goal = ddm::greyOf(ddm::readImageFile(arguments.goal), config.image.size, config.data_set);
  }
  const auto warn = [](const std::string& note) { std::cerr << "warning: " << note << "\n"; };
  ddm::DataSet data = ddm::BagCache(config.image.size, config.data_set, warn).read(arguments.bags);
  if (!goal.empty()) data.setGoal(goal);
  const Eigen::VectorXd limits =
      ddm::perMotor(config.model.max_torque, data.torqueDim(), "model/max_torque");
  Eigen::Index motor = 0;
  const double excess =
      (data.torques().cwiseAbs().rowwise().maxCoeff().array() / limits.array()).maxCoeff(&motor);
  if (excess > 1.0) {
    warn(ddm::textOf("the largest torque of motor ", motor, " in the bags is ",
                     excess * limits(motor), " N m, its limit is ", limits(motor), " N m (",
                     limits_from, "): set model/max_torque to what the motor can do"));
  }
  if (!data.hasGoal()) {
    std::cerr << "no --goal and no goal_image in the bags: the model can predict, but not be "
                 "planned with\n";
  }
  std::cerr << data.numFrames() << " frames in " << data.segments().size() << " segment(s) from "
            << arguments.bags.size() << " bag(s)\n";
  ddm::ModelInfo info;
  info.seed = static_cast<std::uint64_t>(arguments.seed);
  info.trial = static_cast<std::uint32_t>(arguments.bags.size() - 1);
  info.config = ddm::toText(config);
  const ddm::TrainingResult result =
      ddm::train(data, config.model, config.training, info, showProgress);
  if (!result.model) throw std::runtime_error(result.message);
  const std::string bytes = ddm::serialiseModel(*result.model);
  ddm::writeFileAtomically(arguments.out, bytes);
  std::cerr << (::isatty(STDERR_FILENO) != 0 ? "\n" : "");
  std::cout << "model: " << arguments.out << "\nid: " << ddm::modelId(bytes)
            << "\nframes: " << data.numFrames() << "\nsegments: " << data.segments().size()
            << "\ngoal: " << (data.hasGoal() ? "yes" : "none")
            << "\nmax_torque: " << ddm::limitsText(config.model.max_torque)
            << "\nmax_torque_from: " << limits_from << "\nv_r: " << result.model->info().v_r
            << "\nv_p: " << result.model->info().v_p << "\nevaluations: " << result.evaluations
            << "\ntrain_s: " << result.seconds << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  Arguments arguments;
  return ddm::runTool(
      "train_from_bags", [&] { return parse(argc, argv, &arguments); }, [&] { run(arguments); });
}
