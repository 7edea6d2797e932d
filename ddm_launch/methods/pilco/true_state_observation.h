// PILCO's observation of the true state: angle and rate, measured with noise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/plant.h>

#include <random>

#include "observation.h"
#include "pilco_options.h"

namespace ddm {

/// x = (rate, angle) + noise of a pendulum, the angle not wrapped. The only code where the true
/// state meets a policy.
///
/// The noise of a trial is a stream of its own, so that learning from a recorded trial meets the
/// very measurements that the policy acted on in it.
class TrueStateObservation : public Observation {
 public:
  /// @param plant  the one that is controlled, outlives the observation
  /// @throws std::invalid_argument if the plant is not one joint with angle and rate, or if its
  ///         goal is not upright, at pi
  TrueStateObservation(const Plant& plant, const PilcoOptions& options);

  std::vector<std::string> names() const override;
  /// Reads trajectory.csv beside each bag: bags hold no true state.
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  bool keepsCoordinates() const override { return true; }
  PilcoTask task() const override;
  void startTrial(const TrialId& id) override;
  Eigen::VectorXd observe(const Grey& grey) override;

 private:
  Eigen::VectorXd measure(const Eigen::VectorXd& state);

  const Plant& plant_;
  PilcoOptions options_;
  std::mt19937_64 noise_;
};

}  // namespace ddm
