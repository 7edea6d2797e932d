// Model file: a trained model as bytes, with version and checksum.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_file.h"

#include <boost/crc.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace ddm {
namespace {

constexpr char kMagic[] = "DDMMODEL";
constexpr size_t kMagicSize = sizeof(kMagic) - 1;
constexpr std::uint32_t kVersion = 5;
constexpr size_t kHeaderSize = kMagicSize + 4 + 8 + 4;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "model files are little-endian");

std::uint32_t crc32(const char* bytes, size_t size) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes, size);
  return crc.checksum();
}

class Writer {
 public:
  template <class Number>
  void number(Number value) {
    static_assert(std::is_arithmetic<Number>::value, "numbers only");
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  template <class Number>
  void array(const Number* values, size_t count) {
    number<std::uint64_t>(count);
    if (count > 0) bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(Number));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(const char* bytes, size_t size) : at_(bytes), left_(size) {}

  template <class Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof(Number)), sizeof(Number));
    return value;
  }
  template <class Number>
  std::vector<Number> array() {
    const auto count = number<std::uint64_t>();
    if (count > left_ / sizeof(Number))
      throw std::runtime_error("an array is longer than the file");
    std::vector<Number> values(count);
    if (count > 0) std::memcpy(values.data(), take(count * sizeof(Number)), count * sizeof(Number));
    return values;
  }
  bool flag() {
    const auto value = number<std::uint8_t>();
    if (value > 1) throw std::runtime_error("a flag is neither 0 nor 1");
    return value == 1;
  }
  std::string text() {
    const std::vector<char> characters = array<char>();
    return std::string(characters.begin(), characters.end());
  }
  size_t left() const { return left_; }

 private:
  const char* take(size_t size) {
    if (size > left_) throw std::runtime_error("its content ends early");
    const char* const taken = at_;
    at_ += size;
    left_ -= size;
    return taken;
  }

  const char* at_;
  size_t left_;
};

void writeOptions(const ModelOptions& options, Writer* out) {
  const auto widths = [out](const std::vector<int>& values) {
    const std::vector<std::int32_t> fixed(values.begin(), values.end());
    out->array(fixed.data(), fixed.size());
  };
  out->number<std::int32_t>(options.pca_dim);
  out->number<std::int32_t>(options.feature_dim);
  out->number<std::int32_t>(options.order);
  widths(options.encoder_widths);
  widths(options.decoderWidths());
  widths(options.predictor_widths);
  out->number<std::uint8_t>(options.residual ? 1 : 0);
  out->number<std::uint8_t>(options.increments ? 1 : 0);
  out->array(options.max_torque.data(), options.max_torque.size());
  out->number<double>(options.blur);
  out->number<std::int32_t>(options.delay);
}

ModelOptions readOptions(Reader* in) {
  const auto widths = [in] {
    const std::vector<std::int32_t> fixed = in->array<std::int32_t>();
    return std::vector<int>(fixed.begin(), fixed.end());
  };
  ModelOptions options;
  options.pca_dim = in->number<std::int32_t>();
  options.feature_dim = in->number<std::int32_t>();
  options.order = in->number<std::int32_t>();
  options.encoder_widths = widths();
  if (widths() != options.decoderWidths()) {
    throw std::runtime_error("its decoder does not mirror its encoder");
  }
  options.predictor_widths = widths();
  options.residual = in->flag();
  options.increments = in->flag();
  options.max_torque = in->array<double>();
  options.blur = in->number<double>();
  options.delay = in->number<std::int32_t>();
  for (const std::string& problem : options.problems()) throw std::runtime_error(problem);
  return options;
}

/// @param state_dim  rows of support_states
ModelInfo readInfo(size_t state_dim, Reader* in) {
  ModelInfo info;
  info.seed = in->number<std::uint64_t>();
  info.trial = in->number<std::uint32_t>();
  info.frames = in->number<std::uint32_t>();
  info.v_r = in->number<double>();
  info.v_p = in->number<double>();
  info.feature_spread = in->number<double>();
  const std::vector<float> support_states = in->array<float>();
  if (support_states.size() % state_dim != 0)
    throw std::runtime_error("its support states are no states");
  info.support_states = Eigen::Map<const Eigen::MatrixXf>(
      support_states.data(), static_cast<Eigen::Index>(state_dim),
      static_cast<Eigen::Index>(support_states.size() / state_dim));
  info.config = in->text();
  if (!std::isfinite(info.v_r) || !std::isfinite(info.v_p) || !std::isfinite(info.feature_spread) ||
      !info.support_states.allFinite()) {
    throw std::runtime_error(
        "its errors, support states and the spread of its features must be finite");
  }
  return info;
}

Ddm readContent(Reader* in) {
  const ModelOptions options = readOptions(in);
  const int image_size = in->number<std::int32_t>();
  const int torque_dim = in->number<std::int32_t>();
  const auto requireWithin = [](const std::string& name, int value, int largest) {
    if (value >= 1 && value <= largest) return;
    throw std::runtime_error("its " + name + " must lie in [1, " + std::to_string(largest) +
                             "], got " + std::to_string(value));
  };
  requireWithin("image size", image_size, 16384);
  requireWithin("number of motors", torque_dim, 1000);
  const auto state_dim = static_cast<size_t>(options.memory()) * options.feature_dim +
                         static_cast<size_t>(options.memory() - 1) * torque_dim;
  ModelInfo info = readInfo(state_dim, in);
  Pca pca;
  pca.scale = in->number<float>();
  const std::vector<float> mean = in->array<float>();
  const std::vector<float> basis = in->array<float>();
  const std::vector<double> variance = in->array<double>();
  const std::vector<double> theta = in->array<double>();
  Grey goal = in->array<std::uint8_t>();
  const auto num_pixels = static_cast<size_t>(image_size) * image_size;
  const auto pca_dim = static_cast<size_t>(options.pca_dim);
  if (mean.size() != num_pixels || basis.size() != num_pixels * pca_dim ||
      variance.size() != pca_dim) {
    throw std::runtime_error("the sizes of its PCA do not fit");
  }
  pca.blur = Blur(image_size, options.blur);
  pca.mean = Eigen::Map<const Eigen::VectorXf>(mean.data(), mean.size());
  pca.basis = Eigen::Map<const Eigen::MatrixXf>(basis.data(), num_pixels, pca_dim);
  pca.variance = Eigen::Map<const Eigen::VectorXd>(variance.data(), variance.size());
  return Ddm(options, image_size, torque_dim, std::move(pca),
             Eigen::Map<const Eigen::VectorXd>(theta.data(), theta.size()), std::move(goal),
             std::move(info));
}

void writeContent(const Ddm& model, Writer* out) {
  writeOptions(model.options(), out);
  out->number<std::int32_t>(model.imageSize());
  out->number<std::int32_t>(model.torqueDim());
  out->number<std::uint64_t>(model.info().seed);
  out->number<std::uint32_t>(model.info().trial);
  out->number<std::uint32_t>(model.info().frames);
  out->number<double>(model.info().v_r);
  out->number<double>(model.info().v_p);
  out->number<double>(model.info().feature_spread);
  out->array(model.info().support_states.data(),
             static_cast<size_t>(model.info().support_states.size()));
  out->array(model.info().config.data(), model.info().config.size());
  out->number<float>(model.pca().scale);
  out->array(model.pca().mean.data(), model.pca().mean.size());
  out->array(model.pca().basis.data(), model.pca().basis.size());
  out->array(model.pca().variance.data(), model.pca().variance.size());
  out->array(model.theta().data(), model.theta().size());
  out->array(model.goal().data(), model.goal().size());
}

}  // namespace

std::string serialiseModel(const Ddm& model) {
  Writer content;
  writeContent(model, &content);

  Writer header;
  header.number<std::uint32_t>(kVersion);
  header.number<std::uint64_t>(content.bytes().size());
  header.number<std::uint32_t>(crc32(content.bytes().data(), content.bytes().size()));
  return kMagic + header.bytes() + content.bytes();
}

Ddm deserialiseModel(const std::string& bytes, const std::string& source) {
  const auto fail = [&source](const std::string& why) -> std::runtime_error {
    return std::runtime_error("model " + source + ": " + why);
  };
  if (bytes.compare(0, kMagicSize, kMagic) != 0) {
    throw fail("is not a DDM model (it does not begin with " + std::string(kMagic) + ")");
  }
  if (bytes.size() < kHeaderSize) throw fail("is cut short: copy or train it again");
  Reader header(bytes.data() + kMagicSize, kHeaderSize - kMagicSize);
  const auto version = header.number<std::uint32_t>();
  if (version != kVersion) {
    throw fail("has format version " + std::to_string(version) + ", this program reads version " +
               std::to_string(kVersion) + ": train it again from its bags");
  }
  const auto size = header.number<std::uint64_t>();
  if (size != bytes.size() - kHeaderSize) {
    throw fail("is cut short or has grown: " + std::to_string(bytes.size() - kHeaderSize) +
               " bytes of content where it announces " + std::to_string(size) +
               "; copy or train it again");
  }
  if (header.number<std::uint32_t>() != crc32(bytes.data() + kHeaderSize, size)) {
    throw fail("is damaged (wrong checksum): copy or train it again");
  }
  Reader content(bytes.data() + kHeaderSize, size);
  try {
    Ddm model = readContent(&content);
    if (content.left() > 0) throw std::runtime_error("there are bytes after its content");
    return model;
  } catch (const std::exception& e) {
    throw fail(std::string("makes no sense: ") + e.what());
  }
}

std::string checksum(const std::string& text) {
  char digits[9];
  std::snprintf(digits, sizeof(digits), "%08x", crc32(text.data(), text.size()));
  return digits;
}

std::string modelId(const std::string& bytes) { return checksum(bytes); }

}  // namespace ddm
