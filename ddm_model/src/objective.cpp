// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/objective.h"

#include <algorithm>
#include <stdexcept>

namespace ddm {
namespace {

constexpr Eigen::Index kBlock = 128;  // samples whose activations stay in the first-level cache

/// Sum of the squared weights of a network, its biases not among them.
template <class Scalar>
double squaredWeights(const Mlp<Scalar>& net, const Scalar* theta) {
  double sum = 0.0;
  for (int layer = 0; layer < net.numLayers(); ++layer) {
    sum += static_cast<double>(net.weights(theta, layer).squaredNorm());
  }
  return sum;
}

/// Adds the derivative of price times that.
template <class Scalar>
void addDecay(const Mlp<Scalar>& net, const Scalar* theta, Scalar price, Scalar* d_theta) {
  for (int layer = 0; layer < net.numLayers(); ++layer) {
    net.weights(d_theta, layer) += 2 * price * net.weights(theta, layer);
  }
}

}  // namespace

template <class Scalar>
JointObjective<Scalar>::JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data)
    : networks_(networks), data_(std::move(data)), roll_out_(networks.prediction_model) {
  const PredictionModel<Scalar>& f = networks_.prediction_model;
  const Eigen::Index num_images = data_.scores.cols();
  if (data_.scores.rows() != networks_.encoder().inputDim() ||
      data_.torques.rows() != f.torqueDim() || data_.torques.cols() > num_images) {
    throw std::invalid_argument("objective: scores or torques do not fit the networks");
  }
  std::sort(data_.pieces.begin(), data_.pieces.end(),
            [](const Piece& a, const Piece& b) { return a.begin < b.begin; });
  for (const Piece& piece : data_.pieces) {
    if (piece.begin < 0 || piece.begin + piece.size > data_.torques.cols()) {
      throw std::invalid_argument("objective: a piece reaches beyond the frames");
    }
    for (Eigen::Index i = f.memory(); i < piece.size; ++i) {
      targets_.push_back(piece.begin + i);
      piece_end_.push_back(piece.begin + piece.size);
    }
  }
  if (targets_.empty()) {
    throw std::invalid_argument(
        "no prediction can be learned: each piece of the data (frames without a gap, each with its "
        "torque) needs more than model/order + model/delay = " +
        std::to_string(f.memory()) + " frames");
  }
  weight_ = 1.0 / std::max(1e-30, static_cast<double>(data_.scores.squaredNorm()));

  const Eigen::Index num_blocks = (num_images + kBlock - 1) / kBlock;
  for (Eigen::Index block = 0; block <= num_blocks; ++block) {
    const auto first = std::lower_bound(targets_.begin(), targets_.end(), blockBegin(block));
    block_target_.push_back(first - targets_.begin());
  }
  features_.resize(f.featureDim(), num_images);
  d_features_.resize(f.featureDim(), num_images);
}

/// Memory for predictions so many steps ahead.
template <class Scalar>
void JointObjective<Scalar>::reserve(int num_steps) {
  if (residual_.cols() >= (1 + num_steps) * kBlock) return;
  encoder_tapes_.resize(1 + blocksOf(num_steps - 1) + blocksOf(networks_.prediction_model.order()));
  roll_out_.reserve(kBlock, num_steps);
  residual_.resize(data_.scores.rows(), (1 + num_steps) * kBlock);
}

/// How many blocks away from its own a frame may lie that is so many frames away.
template <class Scalar>
Eigen::Index JointObjective<Scalar>::blocksOf(Eigen::Index frames) const {
  return (frames + kBlock - 1) / kBlock;
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
                                                                        const Terms& terms) {
  eigen_assert(theta.size() == networks_.numParams() && terms.prediction_steps >= 1);
  reserve(terms.prediction_steps);
  Scalar* gradient = nullptr;
  if (d_theta != nullptr) {
    d_theta->setZero(theta.size());
    gradient = d_theta->data();
  }
  const auto num_blocks = static_cast<Eigen::Index>(block_target_.size()) - 1;
  const Eigen::Index ahead = blocksOf(terms.prediction_steps - 1);
  const Eigen::Index behind = blocksOf(networks_.prediction_model.order());
  Eigen::Index encoded = 0, finished = 0;
  d_features_.setZero();
  Value value;
  for (Eigen::Index block = 0; block < num_blocks; ++block) {
    while (encoded < std::min(block + ahead + 1, num_blocks)) encode(theta.data(), encoded++);
    const Value part = decodeBlock(theta.data(), block, terms, gradient);
    value.v_r += part.v_r;
    value.v_p += part.v_p;
    if (gradient == nullptr) continue;
    const Eigen::Index last = block + 1 == num_blocks ? block : block - behind;
    while (finished <= last) backwardThroughEncoder(theta.data(), finished++, gradient);
  }
  value.v_w = squaredWeights(theta.data());
  if (gradient == nullptr) return value;
  *d_theta *= Scalar(2);
  addDecay(theta.data(), terms.weight_decay, gradient);
  return value;
}

template <class Scalar>
LayerFactors<Scalar> JointObjective<Scalar>::factors(const Vector& theta, const Terms& terms,
                                                     std::mt19937_64* rng) {
  reserve(terms.prediction_steps);
  LayerFactors<Scalar> encoder = networks_.encoder().zeroFactors();
  LayerFactors<Scalar> decoder = networks_.decoder().zeroFactors();
  LayerFactors<Scalar> f = networks_.f().zeroFactors();
  const auto collect = [this](LayerFactors<Scalar>* of_encoder, LayerFactors<Scalar>* of_decoder,
                              LayerFactors<Scalar>* of_f) {
    for (auto& tape : encoder_tapes_) tape.factors = of_encoder;
    decoder_tape_.factors = of_decoder;
    roll_out_.collect(of_f);
  };
  collect(&encoder, &decoder, &f);
  error_rng_ = rng;
  Vector d_theta;
  evaluate(theta, &d_theta, terms);
  error_rng_ = nullptr;
  collect(nullptr, nullptr, nullptr);
  encoder.insert(encoder.end(), decoder.begin(), decoder.end());
  encoder.insert(encoder.end(), f.begin(), f.end());
  for (KroneckerFactors<Scalar>& layer : encoder) layer.errors *= static_cast<Scalar>(weight_);
  return encoder;
}

/// Replaces residuals by random signs, for factors(). Targets beyond a piece keep their 0.
template <class Scalar>
void JointObjective<Scalar>::drawErrors(Eigen::Index num_images, Eigen::Index columns,
                                        Scalar step_weight) {
  for (Eigen::Index i = 0; i < columns; ++i) {
    if (residual_.col(i).isZero(0)) continue;
    // V counts the square with step_weight, which decodeBlock() multiplies by afterwards.
    const Scalar size = i < num_images ? Scalar(1) : 1 / std::sqrt(step_weight);
    for (Eigen::Index row = 0; row < residual_.rows(); ++row) {
      residual_(row, i) = ((*error_rng_)() & 1) != 0 ? size : -size;
    }
  }
}

/// V_W
template <class Scalar>
double JointObjective<Scalar>::squaredWeights(const Scalar* theta) const {
  return ddm::squaredWeights(networks_.encoder(), networks_.encoderOf(theta)) +
         ddm::squaredWeights(networks_.decoder(), networks_.decoderOf(theta)) +
         ddm::squaredWeights(networks_.f(), networks_.predictorOf(theta));
}

template <class Scalar>
void JointObjective<Scalar>::addDecay(const Scalar* theta, double price, Scalar* d_theta) const {
  if (price == 0.0) return;
  const auto factor = static_cast<Scalar>(price);
  ddm::addDecay(networks_.encoder(), networks_.encoderOf(theta), factor,
                networks_.encoderOf(d_theta));
  ddm::addDecay(networks_.decoder(), networks_.decoderOf(theta), factor,
                networks_.decoderOf(d_theta));
  ddm::addDecay(networks_.f(), networks_.predictorOf(theta), factor,
                networks_.predictorOf(d_theta));
}

template <class Scalar>
void JointObjective<Scalar>::encode(const Scalar* theta, Eigen::Index block) {
  typename Mlp<Scalar>::Tape& tape = encoder_tapes_[block % encoder_tapes_.size()];
  networks_.encoder().forward(networks_.encoderOf(theta),  // g^-1, eq. (3a)
                              data_.scores.middleCols(blockBegin(block), blockSize(block)), &tape);
  features_.middleCols(blockBegin(block), blockSize(block)) = tape.output();
}

/// Once nothing is added to the dV/dz of the block any more.
template <class Scalar>
void JointObjective<Scalar>::backwardThroughEncoder(const Scalar* theta, Eigen::Index block,
                                                    Scalar* d_theta) {
  networks_.encoder().backward(networks_.encoderOf(theta),
                               &encoder_tapes_[block % encoder_tapes_.size()],
                               d_features_.middleCols(blockBegin(block), blockSize(block)),
                               networks_.encoderOf(d_theta), nullptr);
}

/// All terms for the images of one block: their reconstructions and the predictions of them go
/// through the decoder together.
template <class Scalar>
typename JointObjective<Scalar>::Value JointObjective<Scalar>::decodeBlock(const Scalar* theta,
                                                                           Eigen::Index block,
                                                                           const Terms& terms,
                                                                           Scalar* d_theta) {
  const Eigen::Index begin = blockBegin(block);
  const Eigen::Index size = blockSize(block);
  const Eigen::Index first = block_target_[block];
  const Eigen::Index count = block_target_[block + 1] - first;
  const int steps = terms.prediction_steps;
  const Eigen::Index columns = size + steps * count;
  const typename RollOut<Scalar>::Targets targets(targets_.data() + first, count);
  roll_out_.forward(networks_.predictorOf(theta), features_, data_.torques, targets, steps);
  auto codes = networks_.decoder().inputs(columns, &decoder_tape_);
  codes.leftCols(size) = features_.middleCols(begin, size);
  for (int j = 0; j < steps; ++j) {
    codes.middleCols(size + j * count, count) = roll_out_.predicted(j);
  }
  networks_.decoder().forward(networks_.decoderOf(theta), &decoder_tape_);  // g, eq. (3b)

  Value value;
  const auto decoded = decoder_tape_.output();
  residual_.leftCols(size) =
      decoded.leftCols(size) - data_.scores.middleCols(begin, size);  // eq. (1)
  const Scalar step_weight = Scalar(1) / Scalar(steps);
  for (int j = 0; j < steps; ++j) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index frame = targets_[first + i] + j;
      auto residual = residual_.col(size + j * count + i);
      if (frame < piece_end_[first + i]) {
        residual = decoded.col(size + j * count + i) - data_.scores.col(frame);  // eq. (4)
      } else {
        residual.setZero();  // beyond the piece there is nothing to compare with
      }
    }
  }
  value.v_r = static_cast<double>(residual_.leftCols(size).squaredNorm());  // eq. (5c)
  value.v_p =                                                               // eq. (5b)
      static_cast<double>(step_weight * residual_.middleCols(size, steps * count).squaredNorm());
  if (d_theta == nullptr) return value;

  if (error_rng_ != nullptr) drawErrors(size, columns, step_weight);
  // From here on derivatives are those of V / 2: evaluate() doubles them.
  if (!terms.v_r) residual_.leftCols(size).setZero();
  if (!terms.v_p) {
    residual_.middleCols(size, steps * count).setZero();
  } else if (steps > 1) {
    residual_.middleCols(size, steps * count) *= step_weight;
  }
  networks_.decoder().backward(networks_.decoderOf(theta), &decoder_tape_,
                               residual_.leftCols(columns), networks_.decoderOf(d_theta),
                               &d_codes_);
  d_features_.middleCols(begin, size) += d_codes_.leftCols(size);
  for (int j = 0; j < steps; ++j) {
    roll_out_.dPredicted(j) = d_codes_.middleCols(size + j * count, count);
  }
  for (int j = steps - 1; j >= 0; --j) {
    roll_out_.backward(networks_.predictorOf(theta), targets, j, networks_.predictorOf(d_theta),
                       &d_features_, nullptr);
  }
  return value;
}

template class JointObjective<float>;
template class JointObjective<double>;

}  // namespace ddm
