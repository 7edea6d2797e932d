// Everything that a model computes with, as arrays by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <map>
#include <string>

namespace ddm {

/// Bytes of .npy files by name: pca_mean [D], pca_basis [D x pca_dim], pca_variance, pca_scale;
/// encoder_W1, encoder_b1, ..., decoder_W1, ..., f_W1, ...; image_size, feature_dim, torque_dim,
/// order, max_torque (a number, or one for each motor), residual, increments; goal [D] and
/// goal_feature where there is a goal.
std::map<std::string, std::string> modelArrays(const Ddm& model);

}  // namespace ddm
