// Lock-step: simulated time stands still until each image has its torque.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "ddm_sim/sim_options.h"
#include "sim_node.h"

namespace ddm {

/// Shows image t, waits for the torque that carries its stamp, steps, shows image t + 1.
///
///   idle --reset--> image 0 --torque--> image 1 --torque--> ... image num_steps - 1 --torque-->
///   idle
///
/// A frame that the camera loses is never shown: the plant goes on for another dt under the torque
/// of the last one, and the stamps have a gap. A torque with another stamp is counted and ignored.
/// A torque that cannot be applied, or does not come within the watchdog's wall time, ends the
/// trial: idle until the next reset. /clock never runs backwards: each trial starts later than the
/// last one ended, with a gap that no reader can take for a step. Ground truth and /clock come a
/// millisecond of wall time after the image, those of all frames in between at once. Stamps are
/// whole nanoseconds, so equality is exact.
class LockstepSim : public SimNode {
 public:
  LockstepSim(ros::NodeHandle nh, std::unique_ptr<Rig> rig, const SimOptions& options,
              const ShowOptions& show);

 private:
  ros::Time beginTrial(const ddm_msgs::Reset::Request& request) override;
  void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                  const std::string& publisher) override;
  void torqueRefused(const ros::Time& stamp, const std::string& reason) override;

  bool showFrame();
  void tell();
  void onWatchdogTick(const ros::WallTimerEvent& event);
  void endTrial();
  std::string frameName() const;
  ros::Time now() const { return ros::Time().fromNSec(now_ns_); }

  SimOptions options_;
  std::optional<ros::WallRate> pace_;  ///< empty: as fast as torques come
  std::uint64_t step_ns_;              ///< dt [ns]
  std::uint64_t now_ns_;               ///< simulated time = stamp of the frame on show [ns]
  bool running_ = false;               ///< a frame is on show and waits for its torque
  bool first_trial_ = true;            ///< nothing has been shown yet
  std::string trial_;                  ///< "trial 3" or "evaluation 3"
  std::uint32_t num_steps_ = 0;
  std::uint64_t frame_ = 0;    ///< index of the frame on show, among those shown
  std::uint64_t ignored_ = 0;  ///< torques with another stamp, in this trial
  int silent_ticks_ = 0;       ///< watchdog ticks since the frame was shown
  ros::WallTimer watchdog_;
  ros::WallTimer tell_timer_;
};

}  // namespace ddm
