// Rollouts: the regressor h_n, and multi-step predictions of f.
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

/// Fills in h_n for the prediction of the sample `step` steps after each target. Plain loops are
/// used because blocks of a few numbers are slow in Eigen: a sixth of the time of a plan.
template <class Scalar>
void RollOut<Scalar>::fillRegressors(const Eigen::Ref<const Matrix>& Z,
                                     const Eigen::Ref<const Eigen::MatrixXd>& U,
                                     const Targets& targets, int step) {
  const Eigen::Index last_torque = U.cols() - 1;
  for (Eigen::Index i = 0; i < targets.size(); ++i) {
    Scalar* h = &regressors_.coeffRef(0, i);
    for (int lag = 0; lag < f_.order(); ++lag) {  // eq. (2)
      const Eigen::Index frame = targets[i] + step - 1 - lag;
      if (lag < f_.numFeatures()) {
        const Scalar* z =
            lag < step ? &predicted_[step - 1 - lag].coeffRef(0, i) : &Z.coeffRef(0, frame);
        h = std::copy_n(z, f_.featureDim(), h);
      }
      for (int motor = 0; motor < f_.torqueDim(); ++motor) {
        const double u = U(motor, std::min(frame, last_torque)) / f_.maxTorque()[motor];
        *h++ = static_cast<Scalar>(u);
      }
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
    const Scalar* d_h = &d_regressors_.coeffRef(0, i);
    for (int lag = 0; lag < f_.order(); ++lag) {
      const Eigen::Index frame = targets[i] + step - 1 - lag;
      Scalar* d_z = nullptr;
      if (lag < step) {
        d_z = &d_predicted_[step - 1 - lag].coeffRef(0, i);
      } else if (d_Z != nullptr) {
        d_z = &d_Z->coeffRef(0, frame);
      }
      for (int j = 0; lag < f_.numFeatures() && j < f_.featureDim(); ++j, ++d_h) {
        if (d_z != nullptr) d_z[j] += *d_h;
      }
      for (int motor = 0; motor < f_.torqueDim(); ++motor, ++d_h) {
        if (d_U == nullptr) continue;
        (*d_U)(motor, frame) += static_cast<double>(*d_h) / f_.maxTorque()[motor];
      }
    }
  }
}

template class RollOut<float>;
template class RollOut<double>;

}  // namespace ddm
