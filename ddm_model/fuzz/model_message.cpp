// Fuzz target: bytes to a model message, to a model, and back.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/model_message.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/message_bytes.h>
#include <ddm_msgs/testing/fuzzing.h>

#include <optional>

#include "repaired.h"

using ddm::testing::accepts;
using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ddm_msgs::Model message;
  const auto parse = [&] {
    message = ddm::messageFromBytes<ddm_msgs::Model>(reinterpret_cast<const char*>(data), size);
  };
  if (!accepts<std::runtime_error>(parse)) return 0;

  const std::string bytes =
      ddm::testing::repaired(std::string(message.data.begin(), message.data.end()));
  std::optional<ddm::Ddm> model;
  const auto read = [&] { model.emplace(ddm::deserialiseModel(bytes, "on topic model")); };
  if (!accepts<std::runtime_error>(read)) return 0;

  const ddm_msgs::Model again = ddm::toMessage(*model, message.header.stamp);
  require(again.id == ddm::modelId(std::string(again.data.begin(), again.data.end())),
          "a message names its model");
  require(again.feature_dim == static_cast<std::uint32_t>(model->featureDim()) &&
              again.torque_dim == static_cast<std::uint32_t>(model->torqueDim()) &&
              again.image_size == static_cast<std::uint32_t>(model->imageSize()),
          "a message tells the sizes of its model");
  require(ddm::testing::comesBack(bytes, std::string(again.data.begin(), again.data.end())),
          "a model comes back");
  return 0;
}
