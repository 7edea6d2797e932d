// A model on the wire.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_msgs/Model.h>

namespace ddm {

/// The whole model as a message, with its id.
ddm_msgs::Model toMessage(const Ddm& model, const ros::Time& stamp);

}  // namespace ddm
