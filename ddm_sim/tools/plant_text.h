// Writes the plant file that new_plant proposes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mujoco/plant_proposal.h>

#include <string>
#include <vector>

namespace ddm {

/// Name of the contact sheet (PNG) beside a plant file.
std::string imageFile(const std::string& plant_file);

std::string number(double value, const char* format = "%.7g");
std::string list(const std::vector<double>& values);

/// Range of a joint as text: "-1 to 1 rad", or "no limits".
std::string rangeOf(const ModelJoint& joint);

/// Content of a plant file, with the reason for each value as a comment.
std::string plantText(const std::string& model, const std::string& plant_file,
                      const PlantProposal& proposal);

}  // namespace ddm
