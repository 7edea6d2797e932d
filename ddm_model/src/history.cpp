// Controller state x (the last n features and n-1 torques), and support states of a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/history.h"

#include <algorithm>

namespace ddm {

std::vector<Eigen::Index> farthestPoints(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                         Eigen::Index max_count) {
  std::vector<Eigen::Index> chosen = {0};
  // Squared distance of each point to the nearest chosen point.
  Eigen::RowVectorXf distances = (points.colwise() - points.col(0)).colwise().squaredNorm();
  while (static_cast<Eigen::Index>(chosen.size()) < max_count) {
    Eigen::Index farthest;
    if (!(distances.maxCoeff(&farthest) > 0.0F)) break;
    chosen.push_back(farthest);
    distances =
        distances.cwiseMin((points.colwise() - points.col(farthest)).colwise().squaredNorm());
  }
  return chosen;
}

Eigen::MatrixXf supportStates(const Eigen::Ref<const Eigen::MatrixXf>& Z, const DataSet& data,
                              int order, Eigen::Index max_count) {
  const Eigen::Index dim = Z.rows(), motors = data.torqueDim(), num_frames = data.numFrames();
  Eigen::MatrixXf states(order * dim + (order - 1) * motors, num_frames);
  Eigen::MatrixXf changes = Eigen::MatrixXf::Zero(dim, num_frames);  // z_t - z_{t-1}
  for (const Segment& segment : data.segments()) {
    History x(order, static_cast<int>(dim), static_cast<int>(motors));
    for (Eigen::Index t = segment.begin; t < segment.begin + segment.size; ++t) {
      x.observe(Z.col(t).cast<double>());
      states.col(t).head(order * dim) =
          Eigen::Map<const Eigen::VectorXd>(x.features().data(), order * dim).cast<float>();
      states.col(t).tail((order - 1) * motors) =
          Eigen::Map<const Eigen::VectorXd>(x.torques().data(), (order - 1) * motors).cast<float>();
      if (t > segment.begin) changes.col(t) = Z.col(t) - Z.col(t - 1);
      x.apply(data.torques().col(t));
    }
  }
  const Eigen::MatrixXf features = Z.leftCols(num_frames);
  const float spread = (features.colwise() - features.rowwise().mean()).norm();
  const float spread_of_changes = changes.norm();
  Eigen::MatrixXf points(2 * dim, num_frames);
  points << features / (spread > 0.0F ? spread : 1.0F),
      changes / (spread_of_changes > 0.0F ? spread_of_changes : 1.0F);
  const std::vector<Eigen::Index> chosen = farthestPoints(points, max_count);
  Eigen::MatrixXf support_states(states.rows(), static_cast<Eigen::Index>(chosen.size()));
  for (size_t i = 0; i < chosen.size(); ++i) {
    support_states.col(static_cast<Eigen::Index>(i)) = states.col(chosen[i]);
  }
  return support_states;
}

}  // namespace ddm
