// Deep auto-encoder: encoder g^-1 and decoder g between PCA scores and features.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ddm_model/mlp.h"
#include "ddm_model/model_options.h"

namespace ddm {

/// The two networks of the auto-encoder (paper, Sec. 2.1), without their parameters.
///
///   z = g^-1(score; theta_E)  every layer through arctan, the feature too
///   score_hat = g(z; theta_D) hidden layers through arctan, the output linear
template <class Scalar>
struct AutoEncoder {
  Mlp<Scalar> encoder;  ///< g^-1: pca_dim ... feature_dim
  Mlp<Scalar> decoder;  ///< g:    feature_dim ... pca_dim

  /// @throws std::invalid_argument if a width is < 1
  explicit AutoEncoder(const ModelOptions& options)
      : encoder(layers(options.pca_dim, options.encoder_widths, options.feature_dim),
                Mlp<Scalar>::Output::kArctan),
        decoder(layers(options.feature_dim, options.decoder_widths, options.pca_dim),
                Mlp<Scalar>::Output::kLinear) {}

 private:
  static std::vector<int> layers(int first, const std::vector<int>& hidden, int last) {
    std::vector<int> widths = {first};
    widths.insert(widths.end(), hidden.begin(), hidden.end());
    widths.push_back(last);
    return widths;
  }
};

}  // namespace ddm
