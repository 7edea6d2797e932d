// Text of a proposed plant file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mujoco/plant_proposal.h>

#include <string>
#include <vector>

namespace ddm {

/// @return name of the contact sheet (PNG) beside a plant file
std::string contactSheetOf(const std::string& plant_file);

/// @return a number in at most so many significant digits
std::string number(double value, int digits = 7);

/// @return numbers as a YAML list
std::string list(const std::vector<double>& values);

/// @return range of a joint: "-1 to 1 rad", or "no limits"
std::string rangeOf(const ModelJoint& joint);

/// @param model       path of the model file, as the user gave it
/// @param plant_file  name of the plant file
/// @return content of the plant file, with the reason for each value as a comment
std::string plantText(const std::string& model, const std::string& plant_file,
                      const PlantProposal& proposal);

}  // namespace ddm
