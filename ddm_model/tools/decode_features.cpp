// decode_features: the images y_hat = g(z) of given features. Features in, pictures out.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/model_file.h>
#include <ddm_msgs/tool.h>

#include <boost/algorithm/string.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
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

/// The header that the features of a model have: z_1,z_2,...
std::string header(int feature_dim) {
  std::string text;
  for (int i = 1; i <= feature_dim; ++i) text += (i > 1 ? ",z_" : "z_") + std::to_string(i);
  return text;
}

/// A finite decimal number and nothing else: strtod also takes nan, inf and hexadecimal.
bool parseNumber(const std::string& word, double* value) {
  if (word.empty() || word.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  char* end = nullptr;
  *value = std::strtod(word.c_str(), &end);
  return *end == '\0' && std::isfinite(*value);
}

/// @return z  [feature_dim] for each line after the header
/// @throws std::runtime_error with the number of the line, what stands there and the rule
std::vector<Eigen::VectorXd> readFeatures(std::istream& input, int feature_dim) {
  const auto fail = [](std::size_t line, const std::string& rule, const std::string& got) {
    throw std::runtime_error("standard input, line " + std::to_string(line) + ": must be " + rule +
                             ", got '" + got + "'");
  };
  std::vector<Eigen::VectorXd> features;
  std::string text;
  std::getline(input, text);
  boost::trim(text);
  if (text != header(feature_dim)) fail(1, "the header " + header(feature_dim), text);
  for (std::size_t line = 2; std::getline(input, text); ++line) {
    boost::trim(text);
    if (text.empty() && (input >> std::ws).eof()) break;  // blank lines at the end do not count
    std::vector<std::string> words;
    boost::split(words, text, boost::is_any_of(","));
    Eigen::VectorXd z(feature_dim);
    bool good = words.size() == static_cast<std::size_t>(feature_dim);
    for (int i = 0; good && i < feature_dim; ++i)
      good = parseNumber(boost::trim_copy(words[i]), &z[i]);
    if (!good) fail(line, std::to_string(feature_dim) + " finite number(s), comma between", text);
    features.push_back(z);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  if (features.empty()) fail(2, "a feature: there is nothing to decode", "");
  return features;
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
  const std::vector<Eigen::VectorXd> features = readFeatures(std::cin, model.featureDim());
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
