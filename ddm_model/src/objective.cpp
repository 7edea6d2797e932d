// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/objective.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace ddm {
namespace {

constexpr Eigen::Index kMaxPart = 128;  // images of a part; their activations fit in the cache
// Lanes, whatever the number of processors, so that this number does not change the sum.
constexpr size_t kLanes = 8;

}  // namespace

template <class Scalar>
JointObjective<Scalar>::JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data)
    : networks_(networks), data_(std::move(data)) {
  const PredictionModel<Scalar>& f = networks_.prediction_model;
  const Eigen::Index num_images = data_.scores.cols();
  eigen_assert(data_.scores.rows() == networks_.encoder().inputDim() &&
               data_.torques.rows() == f.torqueDim() && data_.torques.cols() <= num_images);
  const Eigen::Index num_parts = std::max<Eigen::Index>(1, (num_images + kMaxPart - 1) / kMaxPart);
  const Eigen::Index part_size = (num_images + num_parts - 1) / num_parts;
  for (Eigen::Index begin = 0; begin < num_images; begin += part_size) {
    const Eigen::Index first = std::max<Eigen::Index>(begin - f.order(), 0);
    parts_.push_back({first, begin, std::min(begin + part_size, num_images), {}, {}});
  }
  for (const Segment& segment : data_.segments) {
    eigen_assert(segment.begin >= 0 && segment.begin + segment.size <= data_.torques.cols());
    for (Eigen::Index i = f.order(); i < segment.size; ++i) {
      Part& part = parts_[(segment.begin + i) / part_size];
      part.targets.push_back(segment.begin + i - part.first);
      part.segment_end.push_back(segment.begin + segment.size - part.first);
    }
  }
  weight_ = 1.0 / std::max(1e-30, static_cast<double>(data_.scores.squaredNorm()));
  lanes_ = std::vector<Lane>(std::min(parts_.size(), kLanes), Lane(f));
  features_.resize(f.featureDim(), num_images);
}

template <class Scalar>
Eigen::Index JointObjective<Scalar>::numPredictions() const {
  size_t sum = 0;
  for (const Part& part : parts_) sum += part.targets.size();
  return static_cast<Eigen::Index>(sum);
}

template <class Scalar>
void JointObjective<Scalar>::requirePredictions() const {
  if (numPredictions() > 0) return;
  throw std::invalid_argument(
      textOf("no prediction can be learned: each segment of the data (frames without a gap, each "
             "with its torque) needs more than model/order = ",
             networks_.prediction_model.order(), " frames"));
}

/// Allocates memory for predictions up to num_steps ahead.
template <class Scalar>
void JointObjective<Scalar>::reserve(int num_steps) {
  const Eigen::Index columns = (1 + num_steps) * kMaxPart;
  for (Lane& lane : lanes_) {
    lane.d_theta.resize(networks_.numParams());
    if (lane.residual.cols() >= columns) continue;
    lane.roll_out.reserve(kMaxPart, num_steps);
    lane.d_features.resize(features_.rows(), kMaxPart + networks_.prediction_model.order());
    lane.residual.resize(data_.scores.rows(), columns);
  }
}

template <class Scalar>
typename JointObjective<Scalar>::Value JointObjective<Scalar>::evaluate(const Vector& theta,
                                                                        Vector* d_theta,
                                                                        const Terms& terms) {
  eigen_assert(theta.size() == networks_.numParams() && terms.prediction_steps >= 1);
  sumOverParts(theta, terms, d_theta != nullptr, nullptr);
  Value value;
  for (const Lane& lane : lanes_) {
    value.v_r += lane.value.v_r;
    value.v_p += lane.value.v_p;
  }
  if (d_theta != nullptr) {
    d_theta->setZero(theta.size());
    for (const Lane& lane : lanes_) *d_theta += 2 * lane.d_theta;
  }
  Eigen::Index begin = 0;  // of a network in theta
  for (const Mlp<Scalar>* net : {&networks_.encoder(), &networks_.decoder(), &networks_.f()}) {
    double sum = 0.0;  // of squared weights, without biases
    for (int layer = 0; layer < net->numLayers(); ++layer) {
      const auto weights = net->weights(theta.data() + begin, layer);
      sum += static_cast<double>(weights.squaredNorm());
      if (d_theta == nullptr || terms.weight_decay == 0.0) continue;
      net->weights(d_theta->data() + begin, layer) +=
          2 * static_cast<Scalar>(terms.weight_decay) * weights;
    }
    value.v_w += sum;
    begin += net->numParams();
  }
  return value;
}

template <class Scalar>
LayerFactors<Scalar> JointObjective<Scalar>::factors(const Vector& theta, const Terms& terms,
                                                     std::mt19937_64* rng) {
  const std::uint64_t seed = (*rng)();
  sumOverParts(theta, terms, true, &seed);
  LayerFactors<Scalar> sum = zeroFactors();
  for (Lane& lane : lanes_) {
    for (size_t layer = 0; layer < sum.size(); ++layer) sum[layer].add(lane.factors[layer]);
    lane.factors.clear();
  }
  for (KroneckerFactors<Scalar>& layer : sum) layer.errors *= static_cast<Scalar>(weight_);
  return sum;
}

/// @return one zero factor for each layer
template <class Scalar>
LayerFactors<Scalar> JointObjective<Scalar>::zeroFactors() const {
  LayerFactors<Scalar> factors;
  for (const Mlp<Scalar>* net : {&networks_.encoder(), &networks_.decoder(), &networks_.f()}) {
    net->appendZeroFactors(&factors);
  }
  return factors;
}

/// Computes the sum of each lane.
/// @param error_seed  not null: draws the errors at the outputs, and computes the derivatives and
///                    Kronecker factors for these errors, see factors()
template <class Scalar>
void JointObjective<Scalar>::sumOverParts(const Vector& theta, const Terms& terms, bool gradient,
                                          const std::uint64_t* error_seed) {
  reserve(terms.prediction_steps);
  const auto num_lanes = static_cast<int>(lanes_.size());
  const auto sumLane = [&](int i) {
    Lane& lane = lanes_[i];
    lane.value = Value();
    lane.d_theta.setZero();
    KroneckerFactors<Scalar>* factors = nullptr;
    if (error_seed != nullptr) {
      lane.factors = zeroFactors();
      factors = lane.factors.data();
    }
    lane.encoder_tape.factors = factors;
    if (factors != nullptr) factors += networks_.encoder().numLayers();
    lane.decoder_tape.factors = factors;
    if (factors != nullptr) factors += networks_.decoder().numLayers();
    lane.roll_out.collect(factors);
    for (size_t p = i; p < parts_.size(); p += lanes_.size()) {
      forward(parts_[p], theta.data(), terms, &lane);
      if (error_seed != nullptr) {
        drawErrors(parts_[p], terms.prediction_steps, std::mt19937_64(*error_seed + p), &lane);
      }
      if (gradient) backward(parts_[p], theta.data(), terms, &lane);
    }
  };
  // An exception (lack of memory) that leaves an OpenMP loop would end the process.
  std::exception_ptr failure;
#pragma omp parallel for schedule(static, 1) if (num_lanes > 1)
  for (int i = 0; i < num_lanes; ++i) {
    try {
      sumLane(i);
    } catch (...) {
#pragma omp critical
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

/// Computes V_R and V_P of a part. Its reconstructions and predictions are decoded in one batch.
/// Stores the residuals in the lane and adds to the value of the lane.
template <class Scalar>
void JointObjective<Scalar>::forward(const Part& part, const Scalar* theta, const Terms& terms,
                                     Lane* lane) {
  const Eigen::Index before = part.begin - part.first;
  const Eigen::Index size = part.end - part.begin;
  const auto count = static_cast<Eigen::Index>(part.targets.size());
  const int steps = terms.prediction_steps;
  networks_.encoder().forward(networks_.encoderOf(theta),  // g^-1, eq. (3a)
                              data_.scores.middleCols(part.first, before + size),
                              &lane->encoder_tape);
  const auto Z = lane->encoder_tape.output();
  features_.middleCols(part.begin, size) = Z.rightCols(size);
  lane->roll_out.forward(networks_.predictorOf(theta), Z,
                         data_.torques.rightCols(data_.torques.cols() - part.first),
                         typename RollOut<Scalar>::Targets(part.targets.data(), count), steps);
  auto codes = networks_.decoder().inputs(size + steps * count, &lane->decoder_tape);
  codes.leftCols(size) = Z.rightCols(size);
  for (int j = 0; j < steps; ++j) {
    codes.middleCols(size + j * count, count) = lane->roll_out.predicted(j);
  }
  networks_.decoder().forward(networks_.decoderOf(theta), &lane->decoder_tape);  // g, eq. (3b)

  const auto decoded = lane->decoder_tape.output();
  Matrix& residual = lane->residual;
  residual.leftCols(size) =
      decoded.leftCols(size) - data_.scores.middleCols(part.begin, size);  // eq. (1)
  for (int j = 0; j < steps; ++j) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index frame = part.targets[i] + j;
      const Eigen::Index column = size + j * count + i;
      if (frame < part.segment_end[i]) {
        residual.col(column) =
            decoded.col(column) - data_.scores.col(part.first + frame);  // eq. (4)
      } else {
        residual.col(column).setZero();  // beyond the segment there is no true image
      }
    }
  }
  lane->value.v_r += static_cast<double>(residual.leftCols(size).squaredNorm());  // eq. (5c)
  lane->value.v_p +=                                                              // eq. (5b)
      static_cast<double>(residual.middleCols(size, steps * count).squaredNorm()) / steps;
}

/// Replaces residuals by random signs, for factors(). Targets beyond a segment keep residual 0.
template <class Scalar>
void JointObjective<Scalar>::drawErrors(const Part& part, int steps, std::mt19937_64 rng,
                                        Lane* lane) {
  const Eigen::Index num_images = part.end - part.begin;
  const auto columns = num_images + steps * static_cast<Eigen::Index>(part.targets.size());
  for (Eigen::Index i = 0; i < columns; ++i) {
    auto residual = lane->residual.col(i);
    if (residual.isZero(0)) continue;
    // V_P divides squares by `steps`, and backward() divides the residuals by `steps`, too.
    const Scalar size = i < num_images ? Scalar(1) : std::sqrt(Scalar(steps));
    for (Eigen::Index row = 0; row < residual.rows(); ++row)
      residual[row] = (rng() & 1) != 0 ? size : -size;
  }
}

/// Adds the gradient of V / 2 of a part to the lane. Overwrites the residuals.
template <class Scalar>
void JointObjective<Scalar>::backward(const Part& part, const Scalar* theta, const Terms& terms,
                                      Lane* lane) const {
  const Eigen::Index before = part.begin - part.first;
  const Eigen::Index size = part.end - part.begin;
  const auto count = static_cast<Eigen::Index>(part.targets.size());
  const int steps = terms.prediction_steps;
  Scalar* d_theta = lane->d_theta.data();
  auto reconstructed = lane->residual.leftCols(size);
  auto predicted = lane->residual.middleCols(size, steps * count);
  if (!terms.v_r) reconstructed.setZero();
  predicted *= terms.v_p ? Scalar(1) / Scalar(steps) : Scalar(0);
  networks_.decoder().backward(networks_.decoderOf(theta), &lane->decoder_tape,
                               lane->residual.leftCols(size + steps * count),
                               networks_.decoderOf(d_theta), &lane->d_codes);
  lane->d_features.leftCols(before).setZero();
  lane->d_features.middleCols(before, size) = lane->d_codes.leftCols(size);
  for (int j = 0; j < steps; ++j) {
    lane->roll_out.dPredicted(j) = lane->d_codes.middleCols(size + j * count, count);
  }
  const typename RollOut<Scalar>::Targets targets(part.targets.data(), count);
  for (int j = steps - 1; j >= 0; --j) {
    lane->roll_out.backward(networks_.predictorOf(theta), targets, j,
                            networks_.predictorOf(d_theta), &lane->d_features, nullptr);
  }
  networks_.encoder().backward(networks_.encoderOf(theta), &lane->encoder_tape,
                               lane->d_features.leftCols(before + size),
                               networks_.encoderOf(d_theta), nullptr);
}

template class JointObjective<float>;
template class JointObjective<double>;

}  // namespace ddm
