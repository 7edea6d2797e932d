// Multi-step prediction: the regressor h_n, and predictions of f put one after the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/roll_out.h"

#include <algorithm>

namespace ddm {

template <class Scalar>
RollOut<Scalar>::RollOut(const PredictionModel<Scalar>& f) : f_(f) {}

template <class Scalar>
void RollOut<Scalar>::reserve(Eigen::Index num_targets, int num_steps) {
  const auto steps = std::max(predicted_.size(), static_cast<size_t>(num_steps));
  const Eigen::Index targets = std::max(regressors_.cols(), num_targets);
  if (steps == predicted_.size() && targets == regressors_.cols()) return;
  tapes_.resize(steps);
  predicted_.assign(steps, Matrix(f_.featureDim(), targets));
  d_predicted_ = predicted_;
  regressors_.resize(f_.regressorDim(), targets);
}

/// h_n of the step that predicts the frame `step` after each target.
template <class Scalar>
void RollOut<Scalar>::fillRegressors(const Eigen::Ref<const Matrix>& Z,
                                     const Eigen::Ref<const Eigen::MatrixXd>& U,
                                     const Targets& targets, int step) {
  const Eigen::Index last_torque = U.cols() - 1;
  for (Eigen::Index i = 0; i < targets.size(); ++i) {
    for (int lag = 0; lag < f_.order(); ++lag) {  // eq. (2)
      const Eigen::Index frame = targets[i] + step - 1 - lag;
      auto z = regressors_.col(i).segment(f_.featureRow(lag), f_.featureDim());
      if (lag < step) {
        z = predicted_[step - 1 - lag].col(i);
      } else {
        z = Z.col(frame);
      }
      regressors_.col(i).segment(f_.torqueRow(lag), f_.torqueDim()) =
          U.col(std::min(frame, last_torque)).cwiseQuotient(f_.maxTorque()).template cast<Scalar>();
    }
  }
}

template <class Scalar>
void RollOut<Scalar>::forward(const Scalar* theta_p, const Eigen::Ref<const Matrix>& Z,
                              const Eigen::Ref<const Eigen::MatrixXd>& U, const Targets& targets,
                              int num_steps, const Vector* offset) {
  reserve(targets.size(), num_steps);
  count_ = targets.size();
  for (int step = 0; step < num_steps; ++step) {
    fillRegressors(Z, U, targets, step);
    f_.forward(theta_p, regressors_.leftCols(count_), &tapes_[step], predicted(step));
    if (offset != nullptr) predicted(step).colwise() += *offset;
  }
}

template <class Scalar>
void RollOut<Scalar>::backward(const Scalar* theta_p, const Targets& targets, int step,
                               Scalar* d_theta_p, Matrix* d_Z, Eigen::MatrixXd* d_U) {
  f_.backward(theta_p, &tapes_[step], dPredicted(step), d_theta_p, &d_regressors_);
  for (Eigen::Index i = 0; i < targets.size(); ++i) {
    for (int lag = 0; lag < f_.order(); ++lag) {
      const Eigen::Index frame = targets[i] + step - 1 - lag;
      const auto d_z = d_regressors_.col(i).segment(f_.featureRow(lag), f_.featureDim());
      if (lag < step) {
        d_predicted_[step - 1 - lag].col(i) += d_z;
      } else if (d_Z != nullptr) {
        d_Z->col(frame) += d_z;
      }
      if (d_U != nullptr) {
        d_U->col(frame) += d_regressors_.col(i)
                               .segment(f_.torqueRow(lag), f_.torqueDim())
                               .template cast<double>()
                               .cwiseQuotient(f_.maxTorque());
      }
    }
  }
}

template class RollOut<float>;
template class RollOut<double>;

}  // namespace ddm
