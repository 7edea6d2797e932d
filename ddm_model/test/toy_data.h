// A small world for tests: a soft blob that a torque moves around a circle.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"
#include "ddm_model/model_options.h"
#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace testing {

constexpr int kToySize = 8;  // pixels

/// A blob on a circle around the image centre.
/// @param angle  [rad]
inline Image toyImage(double angle, int size = kToySize) {
  const double centre = (size - 1) / 2.0;
  const double radius = 0.3 * size;
  const double x = centre + radius * std::sin(angle);
  const double y = centre + radius * std::cos(angle);
  const double width = 0.2 * size;
  Image grey;
  for (int row = 0; row < size; ++row) {
    for (int col = 0; col < size; ++col) {
      const double distance = std::hypot(col - x, row - y) / width;
      grey.push_back(
          static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-distance * distance))));
    }
  }
  return grey;
}

/// One trial: each torque, uniform in +-2 N m, turns the blob by 0.2 rad per N m.
inline DataSet toyTrial(int num_frames, unsigned seed, int size = kToySize) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> torque(-2.0, 2.0);
  DataSet data(size, 1);
  double angle = 0.1 * seed;
  for (int t = 0; t < num_frames; ++t) {
    const double u = torque(rng);
    data.append(toyImage(angle, size), Eigen::VectorXd::Constant(1, u), /*new_segment=*/t == 0);
    angle += 0.2 * u;
  }
  return data;
}

inline ModelOptions toyModelOptions() {
  ModelOptions options;
  options.pca_dim = 6;
  options.encoder_widths = {5};
  options.predictor_widths = {4};
  options.max_torque = {2.0};
  return options;
}

/// A model that was never trained: random, but of the right shapes.
inline Ddm toyModel(bool with_goal = true) {
  const ModelOptions options = toyModelOptions();
  Pca pca;
  pca.mean = randomMatrix(kToySize * kToySize, 1, 1).cast<float>();
  pca.basis = randomMatrix(kToySize * kToySize, options.pca_dim, 2).cast<float>();
  pca.variance = randomMatrix(options.pca_dim, 1, 3).cwiseAbs();
  pca.scale = 0.25F;
  ModelInfo info;
  info.seed = 0x0123456789abcdefULL;
  info.trial = 7;
  info.frames = 800;
  info.v_r = 12.5;
  info.v_p = 0.1 + 0.2;
  info.config = "model:\n  pca_dim: 6\n";
  const Eigen::Index num_params = Networks<double>(options, 1).numParams();
  return Ddm(options, kToySize, 1, pca, randomMatrix(num_params, 1, 4),
             with_goal ? toyImage(3.0) : Image(), info);
}

}  // namespace testing
}  // namespace ddm
