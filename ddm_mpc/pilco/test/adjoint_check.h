// Checks the vector-Jacobian product of a map from a Gaussian to moments.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/testing/gradient_check.h>

#include <functional>
#include <random>

#include "ddm_pilco/moments.h"
#include "random_gp.h"

namespace ddm {
namespace pilco {

using MomentsMap = std::function<Moments(const Gaussian& input)>;
using MomentsAdjoint = std::function<Gaussian(const Gaussian& input, const Moments& d_output)>;

inline double innerProduct(const Moments& a, const Moments& b) {
  return a.mean.dot(b.mean) + a.covariance.cwiseProduct(b.covariance).sum() +
         a.gain.cwiseProduct(b.gain).sum();
}

/// Weights of all entries of M, S and V. Those of S are not symmetric: an adjoint must not rely on
/// that.
inline Moments randomMoments(int input_dim, int output_dim, std::mt19937_64& random) {
  return Moments{normalMatrix(output_dim, 1, 1.0, random),
                 normalMatrix(output_dim, output_dim, 1.0, random),
                 normalMatrix(input_dim, output_dim, 1.0, random)};
}

/// m and all entries of s one after the other; s is read as the symmetric part.
inline Eigen::VectorXd flatten(const Gaussian& gaussian) {
  Eigen::VectorXd flat(gaussian.mean.size() + gaussian.covariance.size());
  flat << gaussian.mean,
      Eigen::Map<const Eigen::VectorXd>(gaussian.covariance.data(), gaussian.covariance.size());
  return flat;
}

inline Gaussian unflatten(const Eigen::VectorXd& flat, int dim) {
  return Gaussian{flat.head(dim),
                  symmetricPart(Eigen::Map<const Eigen::MatrixXd>(flat.data() + dim, dim, dim))};
}

/// Checks dJ/dm and dJ/ds for a random linear J of all outputs.
inline ::testing::AssertionResult adjointMatches(const MomentsMap& map,
                                                 const MomentsAdjoint& adjoint,
                                                 const Gaussian& input, std::mt19937_64& random) {
  const int dim = static_cast<int>(input.mean.size());
  const Moments weights = randomMoments(dim, static_cast<int>(map(input).mean.size()), random);
  const auto J = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Gaussian at = unflatten(x, dim);
    if (gradient != nullptr) *gradient = flatten(adjoint(at, weights));
    return innerProduct(map(at), weights);
  };
  return ddm::testing::gradientMatches(J, flatten(input));
}

}  // namespace pilco
}  // namespace ddm
