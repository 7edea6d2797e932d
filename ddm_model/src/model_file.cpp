// Model file: a trained model as bytes, with version and checksum.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_file.h"

#include <ddm_common/option_checks.h>

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
constexpr std::uint32_t kVersion = 9;
constexpr size_t kHeaderSize = kMagicSize + 4 + 8 + 4;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "model files are little-endian");
static_assert(sizeof(int) == 4, "as in the file");

std::uint32_t crc32(const char* bytes, size_t size) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes, size);
  return crc.checksum();
}

/// Appends numbers, vectors and texts to bytes. The size of a vector or text precedes it.
struct Writer {
  std::string bytes;

  template <class Value>
  void operator()(const Value& value) {
    if constexpr (std::is_arithmetic<Value>::value) {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    } else {
      const auto count = static_cast<std::uint64_t>(value.size());
      (*this)(count);
      if (count == 0) return;
      bytes.append(reinterpret_cast<const char*>(value.data()), count * sizeof(*value.data()));
    }
  }
};

/// Inverse of Writer. Checks each size against the bytes left before it allocates memory.
class Reader {
 public:
  Reader(const char* bytes, size_t size) : at_(bytes), left_(size) {}

  template <class Value>
  void operator()(Value& value) {
    if constexpr (std::is_arithmetic<Value>::value) {
      std::memcpy(&value, take(sizeof(value)), sizeof(value));
    } else {
      std::uint64_t count;
      (*this)(count);
      constexpr size_t kEach = sizeof(*value.data());
      if (count > left_ / kEach) throw std::runtime_error("an array is longer than the file");
      value.resize(count);
      if (count > 0) std::memcpy(value.data(), take(count * kEach), count * kEach);
    }
  }
  size_t left() const { return left_; }

 private:
  const char* take(size_t size) {
    if (size > left_) throw std::runtime_error("its content ends early");
    const char* const begin = at_;
    at_ += size;
    left_ -= size;
    return begin;
  }

  const char* at_;
  size_t left_;
};

/// Everything after the header of a file. Matrices are stored column by column.
struct Content {
  ModelOptions options;
  std::vector<int> decoder_widths;
  int image_size = 0, torque_dim = 0;
  ModelInfo info;
  Eigen::VectorXf support_states, basis;
  Pca pca;
  Eigen::VectorXd theta;
  Image goal;

  /// Passes all values to a Writer or a Reader, in the order of the file.
  template <class Archive>
  void visit(Archive* archive) {
    const auto each = [archive](auto&... values) { ((*archive)(values), ...); };
    each(options.pca_dim, options.feature_dim, options.order);
    each(options.encoder_widths, decoder_widths, options.predictor_widths);
    each(options.max_torque, options.blur, options.predictor);
    each(image_size, torque_dim);
    each(info.seed, info.trial, info.frames, info.v_r, info.v_p, info.feature_spread);
    each(support_states, info.config);
    each(pca.brightness, pca.scale, pca.mean, basis, pca.variance, theta, goal);
  }
};

Content contentOf(const Ddm& model) {
  const auto flat = [](const Eigen::MatrixXf& matrix) {
    return Eigen::Map<const Eigen::VectorXf>(matrix.data(), matrix.size());
  };
  return {model.options(),
          model.options().decoderWidths(),
          model.imageSize(),
          model.torqueDim(),
          model.info(),
          flat(model.info().support_states),
          flat(model.pca().basis),
          model.pca(),
          model.theta(),
          model.goal()};
}

/// @throws std::exception if the content is invalid
Ddm modelOf(Content content) {
  ModelOptions& options = content.options;
  options.normalise_brightness = content.pca.brightness > 0.0F;
  for (const std::string& problem : options.problems()) throw std::runtime_error(problem);
  if (content.decoder_widths != options.decoderWidths()) {
    throw std::runtime_error("its decoder does not mirror its encoder");
  }
  const auto requireWithin = [](const std::string& name, int value, int largest) {
    if (value >= 1 && value <= largest) return;
    throw std::runtime_error(textOf("its ", name, " must lie in [1, ", largest, "], got ", value));
  };
  requireWithin("image size", content.image_size, 16384);
  requireWithin("number of motors", content.torque_dim, 1000);
  const Eigen::Index state_dim =
      options.order * options.feature_dim + (options.order - 1) * content.torque_dim;
  const Eigen::Index num_pixels = Eigen::Index(content.image_size) * content.image_size;
  if (content.support_states.size() % state_dim != 0) {
    throw std::runtime_error("its support states are no states");
  }
  if (content.basis.size() != num_pixels * options.pca_dim ||
      content.pca.variance.size() != options.pca_dim) {
    throw std::runtime_error("the sizes of its PCA do not fit");
  }
  ModelInfo& info = content.info;
  info.support_states = Eigen::Map<const Eigen::MatrixXf>(
      content.support_states.data(), state_dim, content.support_states.size() / state_dim);
  if (!std::isfinite(info.v_r) || !std::isfinite(info.v_p) || !std::isfinite(info.feature_spread) ||
      !info.support_states.allFinite()) {
    throw std::runtime_error(
        "its errors, support states and the spread of its features must be finite");
  }
  content.pca.blur = Blur(content.image_size, options.blur);
  content.pca.basis =
      Eigen::Map<const Eigen::MatrixXf>(content.basis.data(), num_pixels, options.pca_dim);
  return Ddm(options, content.image_size, content.torque_dim, std::move(content.pca),
             std::move(content.theta), std::move(content.goal), std::move(info));
}

}  // namespace

std::string serialiseModel(const Ddm& model) {
  Writer content, header;
  contentOf(model).visit(&content);
  header(kVersion);
  header(std::uint64_t{content.bytes.size()});
  header(crc32(content.bytes.data(), content.bytes.size()));
  return kMagic + header.bytes + content.bytes;
}

Ddm deserialiseModel(const std::string& bytes, const std::string& source) {
  const auto fail = [&source](const auto&... why) {
    return std::runtime_error(textOf("model ", source, ": ", why...));
  };
  if (bytes.compare(0, kMagicSize, kMagic) != 0) {
    throw fail("is not a DDM model (it does not begin with ", kMagic, ")");
  }
  if (bytes.size() < kHeaderSize) throw fail("is cut short: copy or train it again");
  Reader header(bytes.data() + kMagicSize, kHeaderSize - kMagicSize);
  std::uint32_t version, crc;
  std::uint64_t size;
  header(version);
  header(size);
  header(crc);
  if (version != kVersion) {
    throw fail("has format version ", version, ", this program reads version ", kVersion,
               ": train it again from its bags");
  }
  if (size != bytes.size() - kHeaderSize) {
    throw fail("is cut short or has grown: ", bytes.size() - kHeaderSize,
               " bytes of content where it announces ", size, "; copy or train it again");
  }
  if (crc != crc32(bytes.data() + kHeaderSize, size)) {
    throw fail("is damaged (wrong checksum): copy or train it again");
  }
  Reader reader(bytes.data() + kHeaderSize, size);
  try {
    Content content;
    content.visit(&reader);
    if (reader.left() > 0) throw std::runtime_error("there are bytes after its content");
    return modelOf(std::move(content));
  } catch (const std::exception& e) {
    throw fail("makes no sense: ", e.what());
  }
}

std::string checksum(const std::string& text) {
  char digits[9];
  std::snprintf(digits, sizeof(digits), "%08x", crc32(text.data(), text.size()));
  return digits;
}

std::string modelId(const std::string& bytes) { return checksum(bytes); }

}  // namespace ddm
