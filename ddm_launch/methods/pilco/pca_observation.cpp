// PILCO's observation by principal components: scores of one image.
// SPDX-License-Identifier: BSD-3-Clause
#include "pca_observation.h"

#include <stdexcept>

#include "csv_text.h"
#include "image_task.h"

namespace ddm {

std::vector<std::string> PcaObservation::names() const {
  return featureNames(config_.model.pca_dim);
}

Eigen::MatrixXd PcaObservation::learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                                      const TrialId& /*id*/) {
  pca_ = fitPca(data, config_.model.pca_dim, config_.training.score_std);
  const Eigen::MatrixXd Z = pca_.project(data).leftCols(data.numFrames()).cast<double>();
  if (!data.hasGoal())
    throw std::runtime_error(
        "the bags hold no goal image, which tells the goal: record one on goal_image");
  task_ = imageTask(Z, data.pieces(), observe(data.goal()), options_);
  return Z;
}

Eigen::VectorXd PcaObservation::observe(const Grey& grey) {
  return pca_.project(grey).cast<double>();
}

}  // namespace ddm
