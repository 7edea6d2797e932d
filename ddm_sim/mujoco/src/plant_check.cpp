// How a proposed plant behaves, and what its image shows.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "ddm_mujoco/plant_proposal.h"
#include "mechanism.h"

namespace ddm {

using Eigen::VectorXd;

PlantCheck checkPlant(const PlantProposal& proposal, Plant* plant) {
  constexpr double kSeconds = 2.0;
  constexpr int kPoses = 12, kTrials = 5, kTrialSteps = 100, kHoldSteps = 3, kVisible = 8;
  PlantCheck check;
  const auto n = static_cast<Eigen::Index>(proposal.joints.size());
  const VectorXd start = plant->info().start;
  const int steps = std::max(1, static_cast<int>(std::round(kSeconds / plant->info().dt)));
  plant->setState(start);
  for (int i = 0; i < steps; ++i) {
    plant->step(VectorXd::Zero(plant->torqueDim()));
    check.still_speed =
        std::max(check.still_speed, plant->state().tail(n).lpNorm<Eigen::Infinity>());
  }
  std::mt19937_64 engine(3);
  int outside = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    plant->setState(plant->drawStart(engine));
    VectorXd torque(plant->torqueDim());
    for (int i = 0; i < std::max(kTrialSteps, steps); ++i) {
      for (Eigen::Index k = 0; i % kHoldSteps == 0 && k < torque.size(); ++k) {
        const double limit = plant->info().max_torque[k];
        torque[k] = std::uniform_real_distribution<double>(-limit, limit)(engine);
      }
      plant->step(torque);
      check.random_speed =
          std::max(check.random_speed, plant->state().tail(n).lpNorm<Eigen::Infinity>());
      bool beyond = false;
      for (Eigen::Index k = 0; k < n; ++k) {
        const ModelJoint& joint = proposal.joints[static_cast<std::size_t>(k)];
        if (isHinge(joint)) continue;
        const double margin = 0.05 * (joint.shown_upper - joint.shown_lower);
        beyond = beyond || plant->state()[k] < joint.shown_lower - margin ||
                 plant->state()[k] > joint.shown_upper + margin;
      }
      outside += beyond ? 1 : 0;
    }
  }
  check.share_outside = static_cast<double>(outside) / (kTrials * std::max(kTrialSteps, steps));

  const auto change = [&](const VectorXd& a, const VectorXd& b) {  // pixels, largest
    const Picture first = plant->render(a), second = plant->render(b);
    std::pair<int, int> out = {0, 0};
    for (std::size_t i = 0; i < first.bytes.size(); ++i) {
      const int difference = std::abs(first.bytes[i] - second.bytes[i]);
      out.first += difference >= kVisible ? 1 : 0;
      out.second = std::max(out.second, difference);
    }
    return out;
  };
  std::vector<int> pixels;
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    const std::pair<int, int> here = change(proposal.poses[i], proposal.poses[i + 1]);
    pixels.push_back(here.first);
    check.contrast = std::max(check.contrast, here.second);
  }
  std::nth_element(pixels.begin(), pixels.begin() + kPoses / 2, pixels.end());
  check.changed_pixels = pixels[kPoses / 2];
  for (Eigen::Index k = 0; k < n; ++k) {
    const ModelJoint& joint = proposal.joints[static_cast<std::size_t>(k)];
    int seen = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      VectorXd moved = proposal.poses[i];
      const double quarter = 0.25 * (joint.shown_upper - joint.shown_lower);
      moved[k] += moved[k] + quarter > joint.shown_upper ? -quarter : quarter;
      seen = std::max(seen, change(proposal.poses[i], moved).first);
    }
    if (seen == 0) check.unseen.push_back(joint.name);
  }
  return check;
}

}  // namespace ddm
