// The world in this process: plant, recorder, trainer and policy without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/bag_writer.h>
#include <ddm_model/ddm.h>
#include <ddm_mpc/epsilon_greedy.h>
#include <ddm_sim/plant.h>

#include <memory>

#include "configuration.h"
#include "world.h"

namespace ddm {

/// Does what the nodes do in lock-step, with the same cores and the same bags in between: the same
/// configuration and seed give the same torques.
class InProcessWorld : public World {
 public:
  /// @throws std::invalid_argument if the configuration asks for real time
  explicit InProcessWorld(const Configuration& configuration);

  TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) override;
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;

 private:
  EpsilonGreedy makePolicy(const TrialRequest& request) const;

  const Configuration& configuration_;
  std::unique_ptr<Plant> plant_;
  BagCache bags_;
  std::shared_ptr<const Ddm> model_;
};

}  // namespace ddm
