// Fits the Gaussian process of model/predictor gp to features and torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>

#include "ddm_model/data_set.h"
#include "ddm_model/gp_mean.h"
#include "ddm_model/minimise.h"
#include "ddm_model/networks.h"

namespace ddm {

/// Largest number of centres. The time of a plan is proportional to it. With half as many, errors
/// over eight steps near the upright pole were twice as large for one of two data sets of the
/// cart-pole (5,460 images), and equal for the other (4,200 images).
constexpr Eigen::Index kMaxCentres = 2400;

/// Regressors h_n of f and changes of the feature, for all samples of a data set that have n - 1
/// predecessors and a successor.
struct Transitions {
  Eigen::MatrixXd regressors;  ///< inputs of GpMean, one sample per column [regressorDim() x N]
  Eigen::MatrixXd changes;     ///< z_{t+1} - z_t                            [feature_dim x N]
};

/// @param f  with model/predictor gp
/// @param Z  features of the samples of `data`  [feature_dim x >= numFrames()]
Transitions transitionsOf(const PredictionModel<double>& f, const Eigen::MatrixXd& Z,
                          const DataSet& data);

/// Negative logarithm of the marginal likelihood of a Gaussian process with one kernel for all
/// outputs (Rasmussen and Williams, 2006, eq. 2.30), up to a constant, plus a weak prior that keeps
/// those hyper-parameters finite which the data do not determine:
///
///   k(x, x') = s^2 exp(-sum_d (x_d - x'_d)^2 / (2 l_d^2)) + sigma^2 delta(x, x')
///
/// as a function of (log l_1, ..., log l_D, log s, log sigma) for minimise().
/// @param inputs   of standard deviation 1   [D x N]
/// @param outputs  of standard deviation 1   [E x N]
DifferentiableFunction negativeLogLikelihood(const Eigen::MatrixXd& inputs,
                                             const Eigen::MatrixXd& outputs);

/// Fits a sparse Gaussian process with a linear mean function, which ridge regression computes
/// first. The hyper-parameters of the remaining errors maximise the marginal likelihood of at most
/// 400 transitions, which are drawn at random. A pivoted Cholesky decomposition of the kernel
/// matrix selects the centres among all transitions: it takes the transition whose output the
/// centres so far explain worst, until the variance that is not explained is 3 % of the noise's
/// everywhere, or until there are max_centres centres. The weights follow from all transitions
/// (subset of regressors: Rasmussen and Williams, 2006, Sec. 8.3.1).
/// @param rng    draws the transitions
/// @param check  called after each iteration; may throw to cancel the fit
/// @return       parameters of GpMean
/// @throws std::invalid_argument if there are no transitions
Eigen::VectorXd fitGp(const Transitions& transitions, std::mt19937_64* rng,
                      const std::function<void()>& check, Eigen::Index max_centres = kMaxCentres);

/// Removes transitions that a Gaussian process predicts far worse than most others. The features of
/// an image in which the plant cannot be seen say nothing about its state, and a few transitions
/// from and to such images raise the noise that fitGp() estimates for all transitions. The cart of
/// the cart-pole can leave the image: without 4 % of its transitions, the errors over five steps are
/// about half as large. A transition is removed if its squared error exceeds 12 times the median, in units
/// of the spread of each output; errors below 3 % of the spread count as 3 %. After the first round,
/// a Gaussian process that is fitted to the remaining transitions judges all of them again.
/// @param rng, check  see fitGp()
Transitions withoutOutliers(const Transitions& transitions, std::mt19937_64* rng,
                            const std::function<void()>& check);

/// Replaces the network in f by a Gaussian process that is fitted to the features of all samples
/// (model/predictor gp). Deviation: the paper keeps the network f that it trains together with the
/// features. On held-out trials of the pendulum, two links and the cart-pole, the Gaussian process
/// predicts the same features with half to four fifths of the network's error, for few and for many
/// samples.
/// @param theta  parameters of the auto-encoder
/// @param Z      features of all samples                                 [feature_dim x >= N]
/// @param check  called after each iteration; may throw to cancel the fit
/// @return       parameters of the auto-encoder and the Gaussian process
Eigen::VectorXd replaceByGp(const ModelOptions& model, const Eigen::VectorXd& theta,
                            const Eigen::MatrixXd& Z, const DataSet& data, std::mt19937_64* rng,
                            const std::function<void()>& check);

}  // namespace ddm
