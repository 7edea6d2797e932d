// Fuzz targets of ddm_msgs: configuration files and image messages.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_common/param_reader.h>
#include <ddm_msgs/message_bytes.h>
#include <ddm_msgs/testing/fuzzing.h>

#include <algorithm>
#include <cmath>

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

/// A block with each type of value.
struct Options {
  int steps = 15;
  double weight = 0.01;
  bool residual = true;
  std::string topic = "torque";
  std::vector<int> widths = {60};
  std::vector<double> start = {0.0, 1.5};
  std::vector<std::string> names = {"a", "b"};

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("steps", steps);
    visitor("weight", weight);
    visitor("residual", residual);
    visitor("topic", topic);
    visitor("widths", widths);
    visitor("start", start);
    visitor("names", names);
  }
  std::vector<std::string> problems() const {
    const auto bad = [](double value) { return !std::isfinite(value); };
    if (!bad(weight) && std::none_of(start.begin(), start.end(), bad)) return {};
    return {"sim/weight and sim/start must be finite"};
  }
  bool operator==(const Options& other) const {
    return steps == other.steps && weight == other.weight && residual == other.residual &&
           topic == other.topic && widths == other.widths && start == other.start &&
           names == other.names;
  }
};

/// Reads the input as a configuration file.
void configFile(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  Options options;
  const auto read = [&] {
    // Merges some inputs with themselves.
    const std::vector<std::string> files(size % 4 == 0 ? 2 : 1, file.path());
    ddm::ParamReader reader = ddm::ParamReader::fromFiles(files);
    options = reader.read<Options>("sim");
    for (const std::string& problem : reader.problems()) {
      require(!problem.empty(), "a problem is told");
    }
    reader.requireValid();
  };
  if (!accepts<std::invalid_argument>(read)) return;

  YAML::Node root(YAML::NodeType::Map);
  root["sim"] = ddm::toYaml(options);
  const std::string text = YAML::Dump(root);
  file.write(text.data(), text.size());
  ddm::ParamReader saved = ddm::ParamReader::fromFiles({file.path()});
  require(saved.read<Options>("sim") == options, "a saved configuration comes back");
  saved.requireValid();
}

/// Decodes bytes to an image message and then to grey values. Fuzz input: size (1 byte), then 1 and
/// a crop (4 bytes) or 0 for no crop, then the message.
void imageMessage(const std::uint8_t* data, std::size_t size) {
  ddm::testing::FuzzBytes bytes(data, size);
  const int side = bytes.number<std::uint8_t>() % 64;  // 0 is refused
  ddm::ImageCrop crop;
  if (bytes.number<std::uint8_t>() % 2 != 0) {
    crop.x = bytes.number<std::int8_t>();
    crop.y = bytes.number<std::int8_t>();
    crop.width = bytes.number<std::int8_t>();
    crop.height = bytes.number<std::int8_t>();
  }
  const std::string wire = bytes.rest();
  sensor_msgs::Image image;
  const auto parse = [&] {
    image = ddm::messageFromBytes<sensor_msgs::Image>(wire.data(), wire.size());
  };
  if (!accepts<std::runtime_error>(parse)) return;

  std::vector<std::uint8_t> grey;
  const auto decode = [&] { grey = ddm::decodeImage(image, side, crop); };
  if (!accepts<std::invalid_argument>(decode)) return;
  require(grey.size() == static_cast<std::size_t>(side) * side, "an image has size x size pixels");
  require(grey == ddm::decodeImage(image, side, crop), "equal images give equal pixels");
  const sensor_msgs::Image again = ddm::encodeImage(grey, side, image.header.stamp, "camera");
  require(ddm::decodeImage(again, side) == grey, "a mono8 image of this size comes back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target =
      ddm::testing::chosenTarget({{"config_file", configFile}, {"image_message", imageMessage}});
  target(data, size);
  return 0;
}
