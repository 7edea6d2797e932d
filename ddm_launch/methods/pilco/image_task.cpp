// PILCO's task in coordinates that come from images: goal, start and scale from the data.
// SPDX-License-Identifier: BSD-3-Clause
#include "image_task.h"

#include <ddm_pilco/gp_training.h>

#include <cmath>
#include <stdexcept>

namespace ddm {
namespace {

pilco::Gaussian startDistribution(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                                  double distance) {
  const Eigen::Index dim = X.rows();
  Eigen::MatrixXd first(dim, static_cast<Eigen::Index>(pieces.size()));
  for (size_t i = 0; i < pieces.size(); ++i) {
    first.col(static_cast<Eigen::Index>(i)) = X.col(pieces[i].begin);
  }
  const Eigen::VectorXd mean = first.rowwise().mean();
  const Eigen::MatrixXd centred = first.colwise() - mean;
  const Eigen::MatrixXd scatter =
      centred * centred.transpose() +
      distance * distance / static_cast<double>(dim) * Eigen::MatrixXd::Identity(dim, dim);
  return {mean, scatter / static_cast<double>(pieces.size())};
}

}  // namespace

PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                    const Eigen::VectorXd& goal, const PilcoOptions& options) {
  const Eigen::VectorXd std = pilco::sampleStd(X);
  const double spread = std.norm();
  if (!(spread > 0.0)) throw std::runtime_error("all images are observed as the same state");
  const int dim = static_cast<int>(X.rows());
  const double width = options.cost_width * spread;
  const Eigen::MatrixXd weight = Eigen::MatrixXd::Identity(dim, dim) / (width * width);
  return {{},
          startDistribution(X, pieces, options.start_std * spread),
          pilco::StateCost(pilco::replaceAngles(dim, {}), pilco::SaturatingCost(goal, weight)),
          std};
}

}  // namespace ddm
