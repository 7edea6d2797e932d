// model_data: what is written in a model, and what it makes of bags, as YAML and arrays for inspect.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_reader.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_params/config_blocks.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <ros/time.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "array_folder.h"
#include "bag_arguments.h"

namespace po = boost::program_options;

namespace ddm {
namespace {

constexpr Eigen::Index kMaxStarts = 1000;  // predictions of each length: seconds, not minutes

struct Arguments {
  std::string model;
  std::vector<std::string> configs;
  int steps = 15;
  std::string out;
  std::vector<std::string> bags;
  BagArguments data_set;
};

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(
      "Writes what is written in a model, and what it makes of bags, as YAML and\n"
      "NumPy files: what `rosrun ddm_model inspect` shows to people.\n\n"
      "usage: rosrun ddm_model model_data --model FILE --out DIR [--steps K] [--config FILE]...\n"
      "                                   [BAG...]\n\noptions");
  options.add_options()("model", po::value(&arguments->model)->value_name("FILE"), "model file");
  options.add_options()("out", po::value(&arguments->out)->value_name("DIR"),
                        "folder of the files; made if need be");
  options.add_options()("steps", po::value(&arguments->steps)->default_value(arguments->steps),
                        "longest prediction");
  options.add_options()("config", po::value(&arguments->configs)->composing()->value_name("FILE"),
                        "YAML file whose block data_set names the topics; repeatable");
  arguments->data_set.addTo(&options);
  const Positional bags{"bag", po::value(&arguments->bags), -1};
  if (!parseCommandLine(argc, argv, options, bags)) return false;
  if (arguments->model.empty()) throw po::error("--model FILE is missing: say which model");
  if (arguments->out.empty()) throw po::error("--out DIR is missing: say where the files go");
  if (arguments->steps < 1 || arguments->steps > 1000) {
    throw po::error("--steps must lie in [1, 1000], got " + std::to_string(arguments->steps));
  }
  return true;
}

/// Says what is done, and on a terminal how far.
std::function<void(double)> progress(const std::string& what) {
  const bool live = ::isatty(STDERR_FILENO) != 0;
  std::cerr << what << (live ? "" : "\n") << std::flush;
  return [what, live, shown = -1](double fraction) mutable {
    const int percent = static_cast<int>(100.0 * fraction);
    if (!live || percent == shown) return;
    shown = percent;
    std::cerr << "\r" << what << "  " << percent << " %" << (percent == 100 ? "\n" : "")
              << std::flush;
  };
}

std::string factsOf(const Ddm& model, const std::string& id) {
  YAML::Node facts(YAML::NodeType::Map);
  const ModelInfo& info = model.info();
  facts["id"] = id;
  facts["seed"] = std::to_string(info.seed);
  facts["trial"] = std::to_string(info.trial);
  facts["frames"] = std::to_string(info.frames);
  facts["v_r"] = formatDouble(info.v_r);
  facts["v_p"] = formatDouble(info.v_p);
  facts["feature_spread"] = formatDouble(info.feature_spread);
  facts["image_size"] = std::to_string(model.imageSize());
  facts["torque_dim"] = std::to_string(model.torqueDim());
  facts["goal"] = model.hasGoal() ? "true" : "false";
  facts["options"] = toYaml(model.options());
  facts["config"] = info.config;
  return YAML::Dump(facts) + "\n";
}

/// Times of what could not be paired: rows number of the bag, time since its first frame [s].
class Unpaired {
 public:
  void add(std::size_t bag, const std::vector<double>& times) {
    for (const double time : times) columns_.emplace_back(static_cast<double>(bag), time);
  }
  void write(const std::string& name, const ArrayFolder& out) const {
    Eigen::MatrixXd matrix(2, static_cast<Eigen::Index>(columns_.size()));
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) matrix.col(i) = columns_[i];
    out.write(name, matrix);
  }

 private:
  std::vector<Eigen::Vector2d> columns_;
};

/// All bags as one data set. What was found in each is in bags.yaml.
DataSet readBags(const Ddm& model, const Arguments& arguments, const BagOptions& topics,
                 const ArrayFolder& out) {
  DataSet data(model.imageSize(), model.torqueDim());
  const auto show = progress("reading " + std::to_string(arguments.bags.size()) + " bag(s)");
  YAML::Node bags(YAML::NodeType::Sequence);
  std::vector<double> times;
  Unpaired images, torques;
  for (const std::string& path : arguments.bags) {
    const BagContent content = readBag(path, model.imageSize(), topics);
    if (content.data.torqueDim() != model.torqueDim()) {
      throw std::runtime_error("bag " + path + ": has " + std::to_string(content.data.torqueDim()) +
                               " torque(s) a frame, the model has " +
                               std::to_string(model.torqueDim()) + ": it is of another robot");
    }
    YAML::Node bag;
    bag["bag"] = path;
    bag["camera"] = content.camera;
    bag["frames"] = content.data.numFrames();
    bag["pieces"] = content.data.pieces().size();
    bag["images_without_torque"] = content.images_without_torque.size();
    bag["torques_without_image"] = content.torques_without_image.size();
    bag["interval_s"] = formatDouble(content.interval);
    bag["goal"] = content.data.hasGoal() ? 1 : 0;
    images.add(bags.size(), content.images_without_torque);
    torques.add(bags.size(), content.torques_without_image);
    bags.push_back(bag);
    data.append(content.data);
    times.insert(times.end(), content.times.begin(), content.times.end());
    show(static_cast<double>(bags.size()) / static_cast<double>(arguments.bags.size()));
  }
  writeFileAtomically(arguments.out + "/bags.yaml", YAML::Dump(bags) + "\n");
  images.write("images_without_torque", out);
  torques.write("torques_without_image", out);
  out.write("times", Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                         times.data(), static_cast<Eigen::Index>(times.size()))));
  return data;
}

/// @return the decoded image of each feature  [D x N]
GreyMatrix decodeAll(const Ddm& model, const Eigen::MatrixXd& Z) {
  GreyMatrix images(model.pca().mean.size(), Z.cols());
  for (Eigen::Index i = 0; i < Z.cols(); ++i) {
    const Grey grey = model.decode(Z.col(i));
    std::copy(grey.begin(), grey.end(), images.col(i).data());
  }
  return images;
}

/// The predictions that are in the middle, and worst, of all by the distance of the feature
/// predicted last to that of the image that came.
void writeNotable(const Ddm& model, const DataSet& data, const Eigen::MatrixXd& Z,
                  const std::vector<Eigen::Index>& starts, int num_steps, const ArrayFolder& out) {
  std::vector<std::pair<double, Eigen::Index>> ranked;
  for (const Eigen::Index frame : starts) {
    const Eigen::MatrixXd path = model.rollOut(Z, data.torques(), frame, num_steps);
    ranked.emplace_back((path.rightCols(1) - Z.col(frame + num_steps)).norm(), frame);
  }
  std::sort(ranked.begin(), ranked.end());
  const auto write = [&](const std::string& kind, Eigen::Index frame) {
    const Eigen::MatrixXd path = model.rollOut(Z, data.torques(), frame, num_steps);
    out.writeNumber(kind + "_frame", std::int64_t{frame});
    out.write(kind + "_features", path);
    out.write(kind + "_images", decodeAll(model, path));
  };
  write("typical", ranked[ranked.size() / 2].second);
  write("worst", ranked.back().second);
}

/// A row for each column of prediction_errors.csv, a column for each number of steps.
void writePredictions(const Ddm& model, const DataSet& data, const Eigen::MatrixXd& Z,
                      int max_steps, const ArrayFolder& out) {
  int num_steps = max_steps;  // shorter where all pieces are
  while (num_steps > 0 && predictionStarts(model, data, num_steps).empty()) --num_steps;
  Eigen::MatrixXd errors(5, num_steps);
  if (num_steps > 0) {
    const std::vector<Eigen::Index> starts =
        thinnedOut(predictionStarts(model, data, num_steps), kMaxStarts);
    const auto show = progress("predicting " + std::to_string(num_steps) + " step(s) from " +
                               std::to_string(starts.size()) + " frames");
    for (const PredictionError& error : predictionErrors(model, data, starts, num_steps, show)) {
      errors.col(error.steps - 1) << error.steps, static_cast<double>(error.num_predictions),
          error.rmse, error.rmse_repeat, error.rmse_mean_torque;
    }
    writeNotable(model, data, Z, starts, num_steps, out);
  }
  out.write("prediction_errors", errors);
}

void writeFrames(const Ddm& model, const DataSet& data, const Eigen::MatrixXd& Z,
                 const ArrayFolder& out) {
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> piece_sizes(data.pieces().size());
  for (size_t i = 0; i < data.pieces().size(); ++i) piece_sizes[i] = data.pieces()[i].size;
  out.write("piece_sizes", piece_sizes);
  out.write("torques", Eigen::MatrixXd(data.torques()));
  out.write("features", Z);
  out.write("images", data.pixels(0, data.numFrames()));
  out.write("reconstructions", decodeAll(model, Z));
}

void run(const Arguments& arguments) {
  YAML::Node blocks(YAML::NodeType::Map);
  for (const std::string& file : arguments.configs) overlay(readBlocks(file), &blocks);
  arguments.data_set.overlayOn(&blocks);
  ParamReader params(blocks, boost::algorithm::join(arguments.configs, ", "));
  const auto topics = params.read<BagOptions>("data_set");
  params.requireValid();
  const std::string bytes = readFile(arguments.model);
  const Ddm model = deserialiseModel(bytes, arguments.model);
  std::filesystem::create_directories(arguments.out);
  if (!arguments.bags.empty()) {
    const ArrayFolder out(arguments.out + "/bags");
    const DataSet data = readBags(model, arguments, topics, out);
    const Eigen::MatrixXd Z = encodeAll(model, data);
    writeFrames(model, data, Z, out);
    writePredictions(model, data, Z, arguments.steps, out);
  }
  writeFileAtomically(arguments.out + "/model.yaml", factsOf(model, modelId(bytes)));
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::Arguments arguments;
  return ddm::runTool(
      "model_data", [&] { return ddm::parse(argc, argv, &arguments); },
      [&] { ddm::run(arguments); });
}
