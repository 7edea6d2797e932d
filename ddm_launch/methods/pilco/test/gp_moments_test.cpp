// Tests of moment matching through a GP: samples, derivatives, limits and invalid inputs.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/gp_moments.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "random_problems.h"

namespace ddm::pilco {
namespace {

::testing::AssertionResult inputAdjointMatches(const GpModel& model, const Gaussian& input,
                                               std::mt19937_64& random) {
  GpMoments moments(model);
  return adjointMatches([&](const Gaussian& at) { return moments.predict(at); },
                        [&](const Gaussian& at, const Moments& d_output) {
                          GpMoments::Tape tape;
                          moments.predict(at, &tape);
                          return moments.backward(tape, d_output);
                        },
                        input, random);
}

TEST(GpMoments, AreThoseOfSamplesWithAndWithoutModelUncertaintyAlsoForASingularCovariance) {
  std::mt19937_64 random(1);
  for (const bool uncertain : {true, false}) {
    const GpModel model = randomGp(3, 2, 9, uncertain, random);
    const Gaussian input = randomGaussian(3, uncertain ? 3 : 2, 0.6, random);
    EXPECT_TRUE(momentsMatchSamples(GpMoments(model).predict(input), input,
                                    GpSampler(model, &random), random))
        << (uncertain ? "with" : "without") << " model uncertainty";
  }
}

TEST(GpMoments, AdjointMatchesDifferencesForModerateSingularAndZeroCovariance) {
  std::mt19937_64 random(5);
  for (const bool uncertain : {true, false}) {
    for (const int rank : {3, 1, 0}) {
      const GpModel model = randomGp(3, 2, 10, uncertain, random);
      EXPECT_TRUE(inputAdjointMatches(model, randomGaussian(3, rank, 0.5, random), random))
          << "rank " << rank << (uncertain ? "" : ", without model uncertainty");
    }
  }
}

TEST(GpMoments, AreNaNForNumbersThatAreNotFiniteAndForAnIndefiniteCovariance) {
  std::mt19937_64 random(10);
  const GpModel model = randomGp(2, 2, 6, true, random);
  const Gaussian good = randomGaussian(2, 2, 0.5, random);
  const auto isNaN = [&](const GpModel& gp, const Gaussian& input) {
    const Moments output = GpMoments(gp).predict(input);
    return output.mean.array().isNaN().all() && output.covariance.array().isNaN().all() &&
           output.gain.array().isNaN().all();
  };
  EXPECT_FALSE(isNaN(model, good));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Gaussian input = good;
    input.mean[0] = bad;
    EXPECT_TRUE(isNaN(model, input));
    input = good;
    input.covariance(1, 1) = bad;
    EXPECT_TRUE(isNaN(model, input));
    GpModel broken = model;
    broken.beta(0, 0) = bad;
    EXPECT_TRUE(isNaN(broken, good));
    broken = model;
    broken.inverse[1](2, 3) = bad;
    EXPECT_TRUE(isNaN(broken, good));
  }
  Gaussian indefinite = good;
  indefinite.covariance = -1e3 * Eigen::MatrixXd::Identity(2, 2);
  EXPECT_TRUE(isNaN(model, indefinite));
}

}  // namespace
}  // namespace ddm::pilco
