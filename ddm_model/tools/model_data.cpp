// model_data: a model, and what it makes of bags, as files for inspect and export.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/model_config.h>
#include <ddm_files/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <ros/time.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "bag_measurements.h"
#include "model_arrays.h"
#include "npy_file.h"

namespace fs = std::filesystem;
namespace po = boost::program_options;

namespace {

constexpr int kGrid = 9;  // decoded images along each axis of the feature plane, as in the paper

struct Arguments {
  std::string model;
  std::vector<std::string> configs;
  int steps = 15;
  std::string out;
  std::vector<std::string> bags;
};

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(
      "Writes a model, and what it makes of bags, as CSV, YAML and NumPy files: what\n"
      "`rosrun ddm_model inspect` and `rosrun ddm_model export` show to people.\n\n"
      "usage: rosrun ddm_model model_data --model FILE --out DIR [--steps K] [--config FILE]...\n"
      "                                   [BAG...]\n\noptions");
  options.add_options()("model", po::value(&arguments->model)->value_name("FILE"), "model file");
  options.add_options()("out", po::value(&arguments->out)->value_name("DIR"),
                        "folder of the files; made if need be");
  options.add_options()("steps", po::value(&arguments->steps)->default_value(arguments->steps),
                        "longest prediction");
  options.add_options()("config", po::value(&arguments->configs)->composing()->value_name("FILE"),
                        "YAML file whose block data_set names the topics; repeatable");
  po::options_description unnamed;
  unnamed.add_options()("bag", po::value(&arguments->bags));
  po::positional_options_description names;
  names.add("bag", -1);
  if (!ddm::parseCommandLine(argc, argv, options, unnamed, names)) return false;
  if (arguments->model.empty()) throw po::error("--model FILE is missing: say which model");
  if (arguments->out.empty()) throw po::error("--out DIR is missing: say where the files go");
  if (arguments->steps < 1 || arguments->steps > 1000) {
    throw po::error("--steps must lie in [1, 1000], got " + std::to_string(arguments->steps));
  }
  return true;
}

std::string factsOf(const ddm::Ddm& model, const std::string& id) {
  YAML::Node facts(YAML::NodeType::Map);
  const ddm::ModelInfo& info = model.info();
  facts["id"] = id;
  facts["seed"] = std::to_string(info.seed);
  facts["trial"] = std::to_string(info.trial);
  facts["frames"] = std::to_string(info.frames);
  facts["v_r"] = ddm::formatDouble(info.v_r);
  facts["v_p"] = ddm::formatDouble(info.v_p);
  facts["feature_spread"] = ddm::formatDouble(info.feature_spread);
  facts["image_size"] = std::to_string(model.imageSize());
  facts["torque_dim"] = std::to_string(model.torqueDim());
  facts["goal"] = model.hasGoal() ? "true" : "false";
  facts["options"] = ddm::toYaml(model.options());
  facts["config"] = info.config;
  return YAML::Dump(facts) + "\n";
}

/// The smallest range that holds these values and a margin of a twentieth; not quite a point.
std::pair<double, double> rangeOf(const Eigen::VectorXd& values) {
  const double margin = std::max(0.05 * (values.maxCoeff() - values.minCoeff()), 0.02);
  return {values.minCoeff() - margin, values.maxCoeff() + margin};
}

/// Images decoded at 9 x 9 points over the features (without bags: over what the paper shows), as
/// one reads: z_1 to the right, z_2 upwards. One feature gives a row. Those from the third on have
/// the goal's value.
void writePlane(const ddm::Ddm& model, const Eigen::MatrixXd& Z, const std::string& folder) {
  const auto range = [&Z](int i) {
    return Z.cols() > 0 ? rangeOf(Z.row(i).transpose()) : std::make_pair(-1.0, 1.0);
  };
  const auto at = [](const std::pair<double, double>& ends, int k) {
    return ends.first + (ends.second - ends.first) * k / (kGrid - 1);
  };
  Eigen::VectorXd z =
      model.hasGoal() ? model.goalFeature() : Eigen::VectorXd::Zero(model.featureDim());
  const int rows = z.size() > 1 ? kGrid : 1;
  std::vector<std::uint8_t> pixels;
  std::string text = "feature,low,high\n";
  for (int i = 0; i < std::min<int>(2, static_cast<int>(z.size())); ++i) {
    text += std::to_string(i + 1) + "," + ddm::formatDouble(range(i).first) + "," +
            ddm::formatDouble(range(i).second) + "\n";
  }
  for (int row = 0; row < rows; ++row) {
    if (rows > 1) z[1] = at(range(1), kGrid - 1 - row);
    for (int column = 0; column < kGrid; ++column) {
      z[0] = at(range(0), column);
      const ddm::Grey grey = model.decode(z);
      pixels.insert(pixels.end(), grey.begin(), grey.end());
    }
  }
  const Eigen::Index size = model.imageSize();
  ddm::writeFileAtomically(folder + "/plane.csv", text);
  ddm::writeFileAtomically(
      folder + "/arrays/plane.npy",
      ddm::npyBytes("|u1", {rows * kGrid, size, size}, false, pixels.data(), pixels.size()));
}

void run(const Arguments& arguments) {
  ddm::ParamReader params = ddm::ParamReader::fromFiles(arguments.configs);
  const auto topics = params.read<ddm::BagOptions>("data_set");
  params.requireValid();
  const std::string bytes = ddm::readFile(arguments.model);
  const ddm::Ddm model = ddm::deserialiseModel(bytes, arguments.model);
  const std::string& folder = arguments.out;
  fs::create_directories(folder + "/model");
  fs::create_directories(folder + "/arrays");
  Eigen::MatrixXd Z(model.featureDim(), 0);
  if (!arguments.bags.empty()) {
    Z = ddm::measureBags(model, arguments.bags, topics, arguments.steps, folder);
  }
  for (const auto& array : ddm::modelArrays(model)) {
    ddm::writeFileAtomically(folder + "/model/" + array.first + ".npy", array.second);
  }
  writePlane(model, Z, folder);
  ddm::writeFileAtomically(folder + "/model.yaml", factsOf(model, ddm::modelId(bytes)));
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  Arguments arguments;
  return ddm::runTool(
      "model_data", [&] { return parse(argc, argv, &arguments); }, [&] { run(arguments); });
}
