// What the objective is computed from: a part of it.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/training_data.h"

#include <algorithm>

namespace ddm {
namespace {

constexpr Eigen::Index kStretch = 100;     // frames
constexpr Eigen::Index kMinStretches = 4;  // so that even few frames come from several places

}  // namespace

TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than) {
  const Eigen::Index num_frames = data.torques.cols();
  if (num_frames <= max_frames) return data;
  // Stretches of 100 frames could not be spread over fewer frames than that.
  const Eigen::Index length =
      max_frames >= kStretch ? kStretch : std::max(longer_than + 1, max_frames / kMinStretches);
  std::vector<Segment> chosen;
  Eigen::Index seen = 0, taken = 0;
  for (const Segment& segment : data.segments) {
    for (Eigen::Index at = 0; at < segment.size; at += length) {
      const Segment stretch{segment.begin + at, std::min(length, segment.size - at)};
      seen += stretch.size;
      // Keeps stretches until their share of all frames so far is max_frames / num_frames.
      const bool due = (taken + stretch.size) * num_frames <= seen * max_frames;
      if (!due || stretch.size <= longer_than) continue;
      taken += stretch.size;
      chosen.push_back(stretch);
    }
  }
  if (chosen.empty()) return data;
  const Eigen::Index num_others = data.scores.cols() - num_frames;  // the goal
  TrainingData<float> part;
  part.scores.resize(data.scores.rows(), taken + num_others);
  part.scores.rightCols(num_others) = data.scores.rightCols(num_others);
  part.torques.resize(data.torques.rows(), taken);
  Eigen::Index at = 0;
  for (const Segment& segment : chosen) {
    part.scores.middleCols(at, segment.size) = data.scores.middleCols(segment.begin, segment.size);
    part.torques.middleCols(at, segment.size) =
        data.torques.middleCols(segment.begin, segment.size);
    part.segments.push_back({at, segment.size});
    at += segment.size;
  }
  return part;
}

}  // namespace ddm
