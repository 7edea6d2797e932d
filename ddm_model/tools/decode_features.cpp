// decode_features: the images y_hat = g(z) of given features. Features in, pictures out.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_files/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_params/tool.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "feature_csv.h"

namespace fs = std::filesystem;
namespace po = boost::program_options;

namespace {

struct Arguments {
  std::string model;
  std::string frames;
};

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(
      "Decodes features with a trained model, without a ROS master.\n\n"
      "usage: rosrun ddm_model decode_features MODEL.ddm --frames DIR < features.csv\n\n"
      "Input:  the header z_1,z_2,... (as many as the model has features), then one feature a\n"
      "        line.\n"
      "Output: one grey picture a line, 8 bit: DIR/frame_0000.png, ... Nothing is written if any\n"
      "        of the input is wrong.\n"
      "Exit:   0 done, 1 bad model, bad features or a picture that cannot be written, 2 bad\n"
      "        options.\n\noptions");
  options.add_options()("frames", po::value(&arguments->frames)->value_name("DIR"),
                        "folder of the pictures. It is made if need be; pictures of these names "
                        "in it are replaced");
  std::vector<std::string> models;
  po::options_description unnamed;
  unnamed.add_options()("model", po::value(&models));
  po::positional_options_description names;
  names.add("model", -1);
  if (!ddm::parseCommandLine(argc, argv, options, unnamed, names)) return false;
  if (models.size() != 1) {
    throw po::error("one MODEL.ddm must be given, got " + std::to_string(models.size()));
  }
  if (arguments->frames.empty()) {
    throw po::error("--frames DIR is missing: say where the pictures go");
  }
  arguments->model = models.front();
  return true;
}

void writeImage(ddm::Grey grey, int size, const std::string& path) {
  const cv::Mat image(size, size, CV_8UC1, grey.data());
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception&) {  // the path below says more than its text
  }
  if (!written) {
    throw std::runtime_error(path + " cannot be written; check the folder and its disk");
  }
}

void run(const Arguments& arguments) {
  const ddm::Ddm model = ddm::deserialiseModel(ddm::readFile(arguments.model), arguments.model);
  const std::vector<Eigen::VectorXd> features = ddm::readFeatures(std::cin, model.featureDim());
  fs::create_directories(arguments.frames);
  for (std::size_t k = 0; k < features.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof(name), "frame_%04zu.png", k);
    writeImage(model.decode(features[k]), model.imageSize(),
               (fs::path(arguments.frames) / name).string());
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  return ddm::runTool(
      "decode_features", [&] { return parse(argc, argv, &arguments); }, [&] { run(arguments); });
}
