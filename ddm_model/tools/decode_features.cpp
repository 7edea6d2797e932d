// decode_features: the images y_hat = g(z) of given features. Features in, pictures out.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_files/plain_file.h>
#include <ddm_images/image_codec.h>
#include <ddm_model/model_file.h>
#include <ddm_params/number_csv.h>
#include <ddm_params/tool.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

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
  const ddm::Positional model{"model", po::value(&arguments->model)->required(), 1};
  if (!ddm::parseCommandLine(argc, argv, options, model)) return false;
  if (arguments->frames.empty()) {
    throw po::error("--frames DIR is missing: say where the pictures go");
  }
  return true;
}

void run(const Arguments& arguments) {
  const ddm::Ddm model = ddm::deserialiseModel(ddm::readFile(arguments.model), arguments.model);
  std::vector<std::string> names;
  for (int i = 1; i <= model.featureDim(); ++i) names.push_back("z_" + std::to_string(i));
  const auto features = ddm::readNumbers(std::cin, names, "a feature");
  if (features.empty()) throw std::runtime_error("standard input, line 2: there is no feature");
  fs::create_directories(arguments.frames);
  for (std::size_t k = 0; k < features.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof(name), "frame_%04zu.png", k);
    ddm::writePicture(
        (fs::path(arguments.frames) / name).string(),
        ddm::encodeImage(model.decode(features[k]), model.imageSize(), ros::Time(), ""));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  return ddm::runTool(
      "decode_features", [&] { return parse(argc, argv, &arguments); }, [&] { run(arguments); });
}
