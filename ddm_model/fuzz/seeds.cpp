// Writes the seeds of this package's fuzz targets: ddm_model_fuzz_seeds FOLDER.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_options.h>
#include <ddm_bag_io/model_message.h>
#include <ddm_files/plain_file.h>
#include <ddm_images/image_codec.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/testing/seed_files.h>
#include <rosbag/bag.h>
#include <std_msgs/Float64.h>

#include <boost/make_shared.hpp>
#include <cstring>

namespace ddm {
namespace testing {
namespace {

constexpr int kSize = 4;

Ddm smallModel(int num_motors, bool with_goal) {
  ModelOptions options;
  options.pca_dim = 2;
  options.feature_dim = 1;
  options.order = 1;
  options.encoder_widths = {2};
  options.decoder_widths = {};
  options.predictor_widths = {2};
  Pca pca;
  pca.mean = Eigen::VectorXf::Constant(kSize * kSize, 0.5F);
  pca.basis = Eigen::MatrixXf::Constant(kSize * kSize, options.pca_dim, 0.25F);
  pca.variance = Eigen::VectorXd::Ones(options.pca_dim);
  pca.scale = 1.0F;
  ModelInfo info;
  info.frames = 100;
  info.config = "model: {}\n";
  const Eigen::Index num_params = Networks<double>(options, num_motors).numParams();
  return Ddm(options, kSize, num_motors, pca, Eigen::VectorXd::Constant(num_params, 0.1),
             with_goal ? Grey(kSize * kSize, 128) : Grey(), info);
}

void writeModels(const std::string& folder) {
  const SeedFolder files(folder + "/model_file");
  files.write("with_goal", serialiseModel(smallModel(1, true)));
  files.write("two_motors", serialiseModel(smallModel(2, false)));
  std::string old = serialiseModel(smallModel(1, false));
  old[8] = 1;  // its version; not all of the content fits, which is a seed, too
  files.write("version_1", old);
  const SeedFolder messages(folder + "/model_message");
  messages.write("with_goal", bytesOf(toMessage(smallModel(1, true), ros::Time(1.5))));
}

sensor_msgs::Image image(double stamp, std::uint8_t grey) {
  return encodeImage(Grey(kSize * kSize, grey), kSize, ros::Time(stamp), "camera");
}

ddm_msgs::Torque torque(double stamp, double value) {
  ddm_msgs::Torque message;
  message.header.stamp = ros::Time(stamp);
  message.torque = {value};
  return message;
}

/// Without the text of the message's definition, which nobody reads and which is longer than all.
template <class Message>
void add(const std::string& topic, double time, const Message& message, rosbag::Bag* bag) {
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["type"] = ros::message_traits::datatype<Message>();
  (*header)["md5sum"] = ros::message_traits::md5sum<Message>();
  (*header)["message_definition"] = "";
  bag->write(topic, ros::Time(time), message, header);
}

void writeBag(const std::string& path, rosbag::CompressionType compression,
              const std::string& prefix) {
  const BagOptions topics;
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  add(prefix + topics.goal_topic, 1.0, image(1.0, 200), &bag);
  add("plan_cost", 1.0, std_msgs::Float64(), &bag);  // a topic that does not concern us
  for (int t = 0; t < 3; ++t) {
    const double stamp = 1.0 + 0.2 * t;
    add(prefix + topics.image_topic, stamp, image(stamp, static_cast<std::uint8_t>(40 * t)), &bag);
    add(prefix + topics.torque_topic, stamp, torque(stamp, 0.5 * t), &bag);
  }
}

template <class Number>
Number numberAt(const std::string& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, &bytes[at], sizeof(value));
  return value;
}

template <class Number>
void setNumberAt(std::size_t at, Number value, std::string* bytes) {
  std::memcpy(&(*bytes)[at], &value, sizeof(value));
}

/// A bag without the blanks after its header, which are most of a small one.
std::string withoutBlanks(std::string bag) {
  constexpr std::size_t kHeaderAt = 13;  // behind "#ROSBAG V2.0" and the end of that line
  const std::size_t size_at = kHeaderAt + 4 + numberAt<std::uint32_t>(bag, kHeaderAt);
  const auto num_blanks = numberAt<std::uint32_t>(bag, size_at);
  const std::size_t index_at = bag.find("index_pos=") + std::strlen("index_pos=");
  setNumberAt<std::uint64_t>(index_at, numberAt<std::uint64_t>(bag, index_at) - num_blanks, &bag);
  setNumberAt<std::uint32_t>(size_at, 0, &bag);
  return bag.erase(size_at + 4, num_blanks);
}

void writeBags(const std::string& folder) {
  const SeedFolder files(folder + "/bag_file");
  const auto write = [&files](const std::string& name, rosbag::CompressionType compression,
                              const std::string& prefix) {
    writeBag(files.file(name), compression, prefix);
    files.write(name, withoutBlanks(readFile(files.file(name))));
  };
  write("raw", rosbag::compression::Uncompressed, "");
  write("lz4", rosbag::compression::LZ4, "/robot/");
  write("bz2", rosbag::compression::BZ2, "/");
}

std::string entry(char kind, const std::string& message) {
  const auto size = static_cast<std::uint16_t>(message.size());
  return std::string(1, kind) + static_cast<char>(size % 256) + static_cast<char>(size / 256) +
         message;
}

void writeMessages(const std::string& folder) {
  const SeedFolder files(folder + "/bag_messages");
  std::string trial = entry(2, bytesOf(image(1.0, 200)));
  for (int t = 0; t < 3; ++t) {
    trial += entry(1, bytesOf(image(1.0 + 0.2 * t, static_cast<std::uint8_t>(40 * t))));
    trial += entry(0, bytesOf(torque(1.0 + 0.2 * t, 0.5 * t)));
  }
  files.write("trial", trial);
  files.write("frame", entry(1, bytesOf(image(1.0, 9))) + entry(0, bytesOf(torque(1.0, 2.0))));
}

}  // namespace
}  // namespace testing
}  // namespace ddm

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  ros::Time::init();
  ddm::testing::writeModels(argv[1]);
  ddm::testing::writeBags(argv[1]);
  ddm::testing::writeMessages(argv[1]);
  return 0;
}
