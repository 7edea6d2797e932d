// What PILCO takes for the state: the seam between its mathematics and true state or images.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <ddm_mpc/policy.h>
#include <ddm_pilco/moments.h>
#include <ddm_pilco/state_cost.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "driver.h"

namespace ddm {

/// What is to be learned, in the coordinates of an observation.
struct PilcoTask {
  std::vector<int> angles;               ///< entries that are angles [rad]
  pilco::Gaussian start;                 ///< p(x_0)
  pilco::StateCost cost;                 ///< c
  Eigen::VectorXd policy_length_scales;  ///< of the first policy, one for each of its inputs
};

/// Turns what happens into the state x that PILCO learns from and acts on.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Names of the entries of x with their units, as the headers of CSV files have them.
  virtual std::vector<std::string> names() const = 0;

  /// Learns to observe, where there is something to learn, and observes all that is recorded.
  /// @param bags  of all trials, the random one first
  /// @param data  what they hold
  /// @return      x of each frame of `data`                                 [names().size() x N]
  /// @throws std::runtime_error naming what is missing or failed
  virtual Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                                const TrialId& id) = 0;

  /// The coordinates of x are the same after each learn(): what was learned in them stays true.
  virtual bool keepsCoordinates() const = 0;

  /// After learn().
  virtual PilcoTask task() const = 0;

  /// What learn() leaves to be kept: content by name of a file.
  virtual std::map<std::string, std::string> files() const { return {}; }

  virtual void startTrial(const TrialId& id) = 0;

  /// Called once for each frame of a trial, in turn.
  /// @param grey  the image just seen
  /// @return      x
  virtual Eigen::VectorXd observe(const Grey& grey) = 0;
};

}  // namespace ddm
