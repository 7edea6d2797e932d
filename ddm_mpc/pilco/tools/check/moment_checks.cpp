// pilco_check: moments through sines and cosines, and through the squashing.
// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "check/jacobian.h"
#include "check/kinds.h"
#include "ddm_pilco/squashing.h"
#include "ddm_pilco/trigonometric.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

constexpr Tolerance kMoments = absolute(1e-12);

Gaussian readInput(Case* reference) {
  const Eigen::VectorXd mean = reference->vector("m");
  return {mean, reference->covariance("v", mean.size())};
}

/// The field index1, from 0.
std::vector<int> readIndices(Case* reference, Eigen::Index dim) {
  std::vector<int> out;
  const Eigen::VectorXd entries = reference->vector("index1");
  for (Eigen::Index i = 0; i < entries.size(); ++i) {
    const double entry = entries[i];
    if (!(entry >= 1.0 && entry <= static_cast<double>(dim)) || entry != static_cast<int>(entry)) {
      reference->fail("index1", "must hold whole numbers in [1, " + std::to_string(dim) + "]");
    }
    out.push_back(static_cast<int>(entry) - 1);
  }
  return out;
}

void compareMoments(Case* reference, const Moments& computed) {
  reference->compareVector("M", computed.mean, kMoments);
  reference->compareMatrix("V", computed.covariance, kMoments);
  reference->compareMatrix("C", computed.gain, kMoments);
}

void compareJacobian(Case* reference, const std::string& name, const Jacobian& computed) {
  const Eigen::Index dim = computed.mean.cols();
  const std::string in_covariance = "d" + name + "dv";
  reference->compareMatrix("d" + name + "dm", computed.mean, kMoments);
  const Eigen::MatrixXd from_file =
      reference->matrix(in_covariance, computed.mean.rows(), dim * dim);
  reference->compare(in_covariance, symmetrized(from_file, dim), computed.covariance, kMoments);
}

/// @param backward  dJ/d outputs -> dJ/d input, for the outputs of the case
template <class Backward>
void compareJacobians(Case* reference, int input_dim, int output_dim, const Backward& backward) {
  if (!reference->hasGroup({"dMdm", "dVdm", "dCdm", "dMdv", "dVdv", "dCdv"})) return;
  Moments seed = constantMoments(input_dim, output_dim);
  compareJacobian(reference, "M", jacobian(&seed, &seed.mean, input_dim, backward));
  compareJacobian(reference, "V", jacobian(&seed, &seed.covariance, input_dim, backward));
  compareJacobian(reference, "C", jacobian(&seed, &seed.gain, input_dim, backward));
}

std::vector<double> readScales(Case* reference, std::size_t count) {
  const Eigen::VectorXd scales = reference->vector("e", static_cast<Eigen::Index>(count));
  return std::vector<double>(scales.data(), scales.data() + scales.size());
}

/// These columns of an augmentation [e_1 sin, e_1 cos, e_2 sin, ...]: the sines.
Moments sinesOf(const Moments& all) {
  const Eigen::Index count = all.mean.size() / 2;
  Moments out = constantMoments(static_cast<int>(all.gain.rows()), static_cast<int>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    out.mean[i] = all.mean[2 * i];
    out.gain.col(i) = all.gain.col(2 * i);
    for (Eigen::Index j = 0; j < count; ++j) {
      out.covariance(i, j) = all.covariance(2 * i, 2 * j);
    }
  }
  return out;
}

/// The entries of the input with these indices.
Gaussian pick(const Gaussian& input, const std::vector<int>& indices) {
  const Eigen::Index count = static_cast<Eigen::Index>(indices.size());
  Gaussian out = constantGaussian(static_cast<int>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    out.mean[i] = input.mean[indices[i]];
    for (Eigen::Index j = 0; j < count; ++j) {
      out.covariance(i, j) = input.covariance(indices[i], indices[j]);
    }
  }
  return out;
}

}  // namespace

void checkTrigonometric(Case* reference) {
  const Gaussian input = readInput(reference);
  const int dim = static_cast<int>(input.mean.size());
  const std::vector<int> angles = readIndices(reference, dim);
  const Augmentation augmentation(dim, {}, angles, readScales(reference, angles.size()));
  const Moments computed = augmentation.predict(input);
  compareMoments(reference, computed);
  reference->compareMatrix("cov_in_out", input.covariance * computed.gain, kMoments);
  compareJacobians(reference, dim, augmentation.outputDim(),
                   [&](const Moments& seed) { return augmentation.backward(input, seed); });
}

void checkSine(Case* reference) {
  const Gaussian input = readInput(reference);
  const int dim = static_cast<int>(input.mean.size());
  const std::vector<int> angles = readIndices(reference, dim);
  const Augmentation augmentation(dim, {}, angles, readScales(reference, angles.size()));
  compareMoments(reference, sinesOf(augmentation.predict(input)));
}

void checkSquashing(Case* reference) {
  const Gaussian input = readInput(reference);
  const int dim = static_cast<int>(input.mean.size());
  const std::vector<int> indices = readIndices(reference, dim);
  const Eigen::Index count = static_cast<Eigen::Index>(indices.size());
  const Squashing squashing(reference->vector("maxU", count));
  const Gaussian chosen = pick(input, indices);

  Moments computed = squashing.predict(chosen);
  const Eigen::MatrixXd gain = computed.gain;
  computed.gain.setZero(dim, count);
  for (Eigen::Index i = 0; i < count; ++i) computed.gain.row(indices[i]) = gain.row(i);
  compareMoments(reference, computed);

  const auto backward = [&](const Moments& seed) {
    Moments chosen_seed = seed;
    chosen_seed.gain.resize(count, count);
    for (Eigen::Index i = 0; i < count; ++i) chosen_seed.gain.row(i) = seed.gain.row(indices[i]);
    const Gaussian d_chosen = squashing.backward(chosen, chosen_seed);
    Gaussian d_input = constantGaussian(dim);
    for (Eigen::Index i = 0; i < count; ++i) {
      d_input.mean[indices[i]] = d_chosen.mean[i];
      for (Eigen::Index j = 0; j < count; ++j) {
        d_input.covariance(indices[i], indices[j]) = d_chosen.covariance(i, j);
      }
    }
    return d_input;
  };
  compareJacobians(reference, dim, static_cast<int>(count), backward);
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
