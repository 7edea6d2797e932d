// Activation sigma = arctan of the paper (Sec. 2.1) with its slope, computed on whole arrays.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "ddm_model/mlp.h"

namespace ddm {
namespace {

template <class Scalar>
struct Polynomial;

template <>
struct Polynomial<float> {
  static constexpr float kTerms[] = {0.9999999818F,  -0.3333303671F,  0.1999187203F,
                                     -0.1419779779F, 0.1061837064F,   -0.07456854826F,
                                     0.04213762359F, -0.01573124912F, 0.002766283502F};
};

template <>
struct Polynomial<double> {
  static constexpr double kTerms[] = {
      0.99999999999999999912,   -0.33333333333333247768,    0.19999999999986156752,
      -0.14285714284820428681,  0.11111111080383853272,     -0.090909084403388434368,
      0.076922984329856850364,  -0.066665728062897631729,   0.058816472367174149812,
      -0.052591037894858816568, 0.04743705966432169634,     -0.042828645702794473778,
      0.038129809754225042164,  -0.032641162929770771668,   0.025947105703956302528,
      -0.018386836817918876021, 0.011122014669752633411,    -0.0054847789718093558289,
      0.0020906335352636761286, -0.00057279257812920965769, 0.000099784108119530313592,
      -8.2679958173371501883e-6};
};

/// Evaluates p(s) by Horner's rule from term k on. It is a recursion of templates because a loop of
/// 22 terms would keep compilers from vectorising the loop over values.
template <class Scalar, int k = 0>
inline Scalar polynomial(Scalar s) {
  constexpr int kNumTerms = sizeof(Polynomial<Scalar>::kTerms) / sizeof(Scalar);
  if constexpr (k + 1 == kNumTerms) {
    return Polynomial<Scalar>::kTerms[k];
  } else {
    return polynomial<Scalar, k + 1>(s) * s + Polynomial<Scalar>::kTerms[k];
  }
}

// Each ?: selects between values that are computed anyway, because a branch would keep compilers
// from vectorising the loop.
template <class Scalar>
void arctanOf(Scalar* __restrict x, Scalar* __restrict slope, Eigen::Index n) {
  const Scalar half_pi = static_cast<Scalar>(1.57079632679489661923);
  for (Eigen::Index i = 0; i < n; ++i) slope[i] = Scalar(1) / (Scalar(1) + x[i] * x[i]);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Scalar value = x[i];
    const Scalar magnitude = std::abs(value);
    const bool steep = magnitude > Scalar(1);
    const Scalar numerator = steep ? Scalar(-1) : magnitude;
    const Scalar denominator = steep ? magnitude : Scalar(1);
    const Scalar r = numerator / denominator;
    x[i] = std::copysign((steep ? half_pi : Scalar(0)) + r * polynomial(r * r), value);
  }
}

}  // namespace

void arctan(float* x, float* slope, Eigen::Index n) { arctanOf(x, slope, n); }
void arctan(double* x, double* slope, Eigen::Index n) { arctanOf(x, slope, n); }

}  // namespace ddm
