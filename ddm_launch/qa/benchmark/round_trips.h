// Round trips of images and torques between nodes, for `rosrun ddm_launch qa benchmark`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {

/// Runs one node of a loop, if the first argument says so; the second is the number of round trips.
/// The one that times them prints their mean [us].
///
///   lockstep         has the real nodes run a random trial, without recorder
///   bare_camera      publishes an image as soon as the last one has its torque
///   bare_controller  answers images by torques
///
/// @return false if the first argument is another
/// @throws std::runtime_error if the nodes do not come or nothing was timed
bool timesRoundTrips(int argc, char** argv);

}  // namespace ddm
