// Converts a model to a message.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/Model.h>

namespace ddm {

/// Makes the message of a model, with its id and its bytes.
inline ddm_msgs::Model toMessage(const Ddm& model, const ros::Time& stamp) {
  const std::string bytes = serialiseModel(model);
  ddm_msgs::Model message;
  message.header.stamp = stamp;
  message.id = modelId(bytes);
  message.trial = model.info().trial;
  message.frames = model.info().frames;
  message.seed = model.info().seed;
  message.image_size = static_cast<std::uint32_t>(model.imageSize());
  message.feature_dim = static_cast<std::uint32_t>(model.featureDim());
  message.torque_dim = static_cast<std::uint32_t>(model.torqueDim());
  message.order = static_cast<std::uint32_t>(model.options().order);
  message.v_r = model.info().v_r;
  message.v_p = model.info().v_p;
  message.config_hash = checksum(model.info().config);
  message.data.assign(bytes.begin(), bytes.end());
  return message;
}

}  // namespace ddm
