// Initial weights of the three networks of the deep dynamical model.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/networks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

/// Standard deviation of a layer's leading unit before arctan. Above 1, arctan would saturate.
constexpr double kLayerStd = 0.3;

/// Initialises an encoder layer and the decoder layer that mirrors it by the PCA of the inputs.
/// @param inputs  inputs of the encoder layer         [width_in x M]
/// @return        outputs of the encoder layer        [width_out x M]
Eigen::MatrixXd initialisePair(const Eigen::MatrixXd& inputs, Eigen::Map<Eigen::MatrixXd> encoder_w,
                               Eigen::Map<Eigen::VectorXd> encoder_b,
                               Eigen::Map<Eigen::MatrixXd> decoder_w,
                               Eigen::Map<Eigen::VectorXd> decoder_b) {
  const Eigen::VectorXd mean = inputs.rowwise().mean();
  const Eigen::MatrixXd centred = inputs.colwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(centred * centred.transpose() /
                                                             static_cast<double>(inputs.cols()));
  const Eigen::Index rank = std::min(encoder_w.rows(), inputs.rows());
  Eigen::MatrixXd basis = eigen.eigenvectors().rightCols(rank).rowwise().reverse();
  for (Eigen::Index k = 0; k < rank; ++k) {
    Eigen::Index largest;
    basis.col(k).cwiseAbs().maxCoeff(&largest);
    if (basis(largest, k) < 0.0) basis.col(k) *= -1.0;  // eigenvectors have an arbitrary sign
  }
  const double spread = std::sqrt(std::max(eigen.eigenvalues().tail<1>()[0], 1e-12));
  const double c = kLayerStd / spread;
  encoder_w.topRows(rank) = c * basis.transpose();
  encoder_b.head(rank) = -c * basis.transpose() * mean;
  decoder_w.leftCols(rank) = basis / c;
  decoder_b = mean;
  return ((encoder_w * inputs).colwise() + encoder_b).array().atan();
}

/// Copies layers of a network into a network that contains several such networks side by side.
/// Blocks of weights between different networks stay 0.
/// @param number         of the copied network within `all`
/// @param common_input   all networks have the same input
/// @param common_output  the output is the sum of the outputs, each weighted by `share`
void copyLayers(const Mlp<double>& one, const double* theta, const Mlp<double>& all,
                double* all_theta, Eigen::Index number, bool common_input, bool common_output,
                double share) {
  const int last = one.numLayers() - 1;
  for (int layer = 0; layer <= last; ++layer) {
    const Eigen::MatrixXd w = one.weights(theta, layer);
    const Eigen::VectorXd b = one.biases(theta, layer);
    const bool sum = common_output && layer == last;
    const Eigen::Index row = sum ? 0 : number * w.rows();
    const Eigen::Index col = common_input && layer == 0 ? 0 : number * w.cols();
    const double scale = sum ? share : 1.0;
    all.weights(all_theta, layer).block(row, col, w.rows(), w.cols()) = scale * w;
    all.biases(all_theta, layer).segment(row, b.size()) += scale * b;
  }
}

}  // namespace

Eigen::VectorXd initialTheta(const Networks<double>& networks, const Eigen::MatrixXd& scores,
                             bool pca_start, std::mt19937_64* rng) {
  const Mlp<double>& encoder = networks.encoder();
  const Mlp<double>& decoder = networks.decoder();
  Eigen::VectorXd theta(networks.numParams());
  double* const theta_e = networks.encoderOf(theta.data());
  double* const theta_d = networks.decoderOf(theta.data());
  randomise(networks.f(), rng, networks.predictorOf(theta.data()));
  randomise(encoder, rng, theta_e);
  randomise(decoder, rng, theta_d);

  if (!pca_start) return theta;
  Eigen::MatrixXd inputs = scores;
  for (int layer = 0; layer < encoder.numLayers(); ++layer) {
    const int mirror = decoder.numLayers() - 1 - layer;
    inputs = initialisePair(inputs, encoder.weights(theta_e, layer), encoder.biases(theta_e, layer),
                            decoder.weights(theta_d, mirror), decoder.biases(theta_d, mirror));
  }
  return theta;
}

ModelOptions joinedOptions(ModelOptions one, int count) {
  one.feature_dim *= count;
  for (int& width : one.encoder_widths) width *= count;
  return one;
}

Eigen::VectorXd joinAutoEncoders(const ModelOptions& one,
                                 const std::vector<Eigen::VectorXd>& thetas) {
  const auto torque_dim = static_cast<int>(one.max_torque.size());  // does not matter here
  const auto count = static_cast<int>(thetas.size());
  const Networks<double> part(one, torque_dim), all(joinedOptions(one, count), torque_dim);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(all.numOfAutoEncoder());
  for (int i = 0; i < count; ++i) {
    const double* own = thetas[static_cast<size_t>(i)].data();
    copyLayers(part.encoder(), part.encoderOf(own), all.encoder(), all.encoderOf(theta.data()), i,
               /*common_input=*/true, /*common_output=*/false, 1.0);
    copyLayers(part.decoder(), part.decoderOf(own), all.decoder(), all.decoderOf(theta.data()), i,
               /*common_input=*/false, /*common_output=*/true, 1.0 / count);
  }
  return theta;
}

}  // namespace ddm
