// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/objective.h"

#include <algorithm>
#include <stdexcept>

namespace ddm {
namespace {

constexpr Eigen::Index kBlock = 128;  // samples whose activations stay in the first-level cache

}  // namespace

template <class Scalar>
JointObjective<Scalar>::JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data)
    : networks_(networks), data_(std::move(data)) {
  const PredictionModel<Scalar>& f = networks_.prediction_model;
  const Eigen::Index num_images = data_.scores.cols();
  if (data_.scores.rows() != networks_.encoder().inputDim() ||
      data_.torques.rows() != f.torqueDim() || data_.torques.cols() > num_images) {
    throw std::invalid_argument("objective: scores or torques do not fit the networks");
  }
  for (const Piece& piece : data_.pieces) {
    if (piece.begin < 0 || piece.begin + piece.size > data_.torques.cols()) {
      throw std::invalid_argument("objective: a piece reaches beyond the frames");
    }
    for (Eigen::Index i = f.order(); i < piece.size; ++i) targets_.push_back(piece.begin + i);
  }
  if (targets_.empty()) {
    throw std::invalid_argument(
        "no prediction can be learned: each piece of the data (frames without a gap, each with its "
        "torque) needs more than model/order = " +
        std::to_string(f.order()) + " frames");
  }
  std::sort(targets_.begin(), targets_.end());
  weight_ = 1.0 / std::max(1e-30, static_cast<double>(data_.scores.squaredNorm()));

  const Eigen::Index num_blocks = (num_images + kBlock - 1) / kBlock;
  for (Eigen::Index block = 0; block <= num_blocks; ++block) {
    const auto first = std::lower_bound(targets_.begin(), targets_.end(), blockBegin(block));
    block_target_.push_back(first - targets_.begin());
  }
  encoder_tapes_.resize(num_blocks);
  features_.resize(f.featureDim(), num_images);
  d_features_.resize(f.featureDim(), num_images);
  regressors_.resize(f.regressorDim(), kBlock);
  decoder_input_.resize(f.featureDim(), 2 * kBlock);
  residual_.resize(data_.scores.rows(), 2 * kBlock);
}

template <class Scalar>
Eigen::Index JointObjective<Scalar>::blockBegin(Eigen::Index block) const {
  return std::min(block * kBlock, data_.scores.cols());
}

template <class Scalar>
Eigen::Index JointObjective<Scalar>::blockSize(Eigen::Index block) const {
  return blockBegin(block + 1) - blockBegin(block);
}

template <class Scalar>
typename JointObjective<Scalar>::Value JointObjective<Scalar>::evaluate(const Vector& theta,
                                                                        Vector* d_theta,
                                                                        Terms terms) {
  eigen_assert(theta.size() == networks_.numParams());
  Scalar* gradient = nullptr;
  if (d_theta != nullptr) {
    d_theta->setZero(theta.size());
    gradient = d_theta->data();
  }
  const Eigen::Index num_blocks = static_cast<Eigen::Index>(encoder_tapes_.size());
  encode(theta.data());
  d_features_.setZero();
  Value value;
  for (Eigen::Index block = 0; block < num_blocks; ++block) {
    const Value part = decodeBlock(theta.data(), block, terms, gradient);
    value.v_r += part.v_r;
    value.v_p += part.v_p;
  }
  if (gradient == nullptr) return value;
  for (Eigen::Index block = 0; block < num_blocks; ++block) {
    networks_.encoder().backward(networks_.encoderOf(theta.data()), &encoder_tapes_[block],
                                 d_features_.middleCols(blockBegin(block), blockSize(block)),
                                 networks_.encoderOf(gradient), nullptr);
  }
  return value;
}

template <class Scalar>
void JointObjective<Scalar>::encode(const Scalar* theta) {
  for (size_t block = 0; block < encoder_tapes_.size(); ++block) {
    const Eigen::Index begin = blockBegin(block);
    const Eigen::Index size = blockSize(block);
    networks_.encoder().forward(networks_.encoderOf(theta), data_.scores.middleCols(begin, size),
                                &encoder_tapes_[block]);
    features_.middleCols(begin, size) = encoder_tapes_[block].output();
  }
}

/// Both terms for the images of one block: their reconstructions and the predictions of them go
/// through the decoder together.
template <class Scalar>
typename JointObjective<Scalar>::Value JointObjective<Scalar>::decodeBlock(const Scalar* theta,
                                                                           Eigen::Index block,
                                                                           Terms terms,
                                                                           Scalar* d_theta) {
  const Eigen::Index begin = blockBegin(block);
  const Eigen::Index size = blockSize(block);
  const Eigen::Index first = block_target_[block];
  const Eigen::Index count = block_target_[block + 1] - first;
  predict(theta, first, count);
  decoder_input_.leftCols(size) = features_.middleCols(begin, size);
  decoder_input_.middleCols(size, count) = predictor_tape_.output();
  networks_.decoder().forward(networks_.decoderOf(theta), decoder_input_.leftCols(size + count),
                              &decoder_tape_);

  residual_.leftCols(size + count) = decoder_tape_.output();
  residual_.leftCols(size) -= data_.scores.middleCols(begin, size);
  for (Eigen::Index i = 0; i < count; ++i) {
    residual_.col(size + i) -= data_.scores.col(targets_[first + i]);
  }
  Value value;
  value.v_r = static_cast<double>(residual_.leftCols(size).squaredNorm());
  value.v_p = static_cast<double>(residual_.middleCols(size, count).squaredNorm());
  if (d_theta == nullptr) return value;

  residual_.leftCols(size) *= Scalar(terms.v_r ? 2 : 0);
  residual_.middleCols(size, count) *= Scalar(terms.v_p ? 2 : 0);
  networks_.decoder().backward(networks_.decoderOf(theta), &decoder_tape_,
                               residual_.leftCols(size + count), networks_.decoderOf(d_theta),
                               &d_decoder_input_);
  d_features_.middleCols(begin, size) += d_decoder_input_.leftCols(size);
  backwardThroughPrediction(theta, first, count, d_decoder_input_.middleCols(size, count), d_theta);
  return value;
}

template <class Scalar>
void JointObjective<Scalar>::predict(const Scalar* theta, Eigen::Index first, Eigen::Index count) {
  const PredictionModel<Scalar>& f = networks_.prediction_model;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index target = targets_[first + i];
    for (int lag = 0; lag < f.order(); ++lag) {
      const Eigen::Index frame = target - 1 - lag;
      regressors_.col(i).segment(f.featureRow(lag), f.featureDim()) = features_.col(frame);
      regressors_.col(i).segment(f.torqueRow(lag), f.torqueDim()) = data_.torques.col(frame);
    }
  }
  f.network().forward(networks_.predictorOf(theta), regressors_.leftCols(count), &predictor_tape_);
}

template <class Scalar>
void JointObjective<Scalar>::backwardThroughPrediction(const Scalar* theta, Eigen::Index first,
                                                       Eigen::Index count,
                                                       const Eigen::Ref<const Matrix>& d_predicted,
                                                       Scalar* d_theta) {
  const PredictionModel<Scalar>& f = networks_.prediction_model;
  f.network().backward(networks_.predictorOf(theta), &predictor_tape_, d_predicted,
                       networks_.predictorOf(d_theta), &d_regressors_);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int lag = 0; lag < f.order(); ++lag) {
      d_features_.col(targets_[first + i] - 1 - lag) +=
          d_regressors_.col(i).segment(f.featureRow(lag), f.featureDim());
    }
  }
}

template class JointObjective<float>;
template class JointObjective<double>;

}  // namespace ddm
