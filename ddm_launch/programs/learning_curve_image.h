// The learning curve as a picture: what the model after each trial could do.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// Above: distance from the goal at the end of each greedy run, blue dots where it is a success,
/// red crosses where not; where the true state is not known, a row of dots and a row of crosses.
/// Below: V_R (grey) and V_P (orange) per frame, on a logarithmic axis. Both over the frames that
/// were learned from.
/// @param rows        of trials.csv; none is fine
/// @param all_frames  of the whole experiment: the picture grows to the right up to there
/// @param evaluation  unit of the error, and below which the goal is reached
/// @return            8 bit red, green, blue  [480 x 640]
cv::Mat drawLearningCurve(const std::vector<TrialRow>& rows, std::uint32_t all_frames,
                          const EvaluationOptions& evaluation);

}  // namespace ddm
