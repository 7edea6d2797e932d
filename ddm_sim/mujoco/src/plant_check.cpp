// Checks that a plant moves, and that its images show the motion.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include "ddm_mujoco/mujoco_plant.h"
#include "ddm_mujoco/plant_proposal.h"
#include "ddm_sim/plant.h"
#include "mechanism.h"

namespace ddm {
namespace {

using Eigen::VectorXd;

/// Number of pixels that differ by at least `levels` grey levels.
int numDifferent(const RenderedImage& a, const RenderedImage& b, int levels) {
  int count = 0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) {
    count += std::abs(a.bytes[i] - b.bytes[i]) >= levels ? 1 : 0;
  }
  return count;
}

std::string point(const Eigen::Vector3d& at) {
  std::ostringstream text;
  const Eigen::Vector3d rounded = (1e3 * at.array()).round() / 1e3 + 0.0;
  text << '(' << rounded[0] << ", " << rounded[1] << ", " << rounded[2] << ')';
  return text.str();
}

/// Likely cause of images that do not change.
std::string whyUnseen(const mjModel& model, const RenderedImage& rendered) {
  int moving = 0, drawn = 0;
  for (int i = 0; i < model.ngeom; ++i) {
    moving += model.body_weldid[model.geom_bodyid[i]] != 0 ? 1 : 0;
    drawn += isDrawnAndMoves(model, i) ? 1 : 0;
  }
  if (moving == 0) {
    return "no link that a joint moves has a shape; give one a <visual> (URDF) or a <geom> (MJCF)";
  }
  if (drawn == 0)
    return "all shapes that move are transparent; give them an opacity (rgba) above 0";
  const auto ends = std::minmax_element(rendered.bytes.begin(), rendered.bytes.end());
  if (*ends.second < 10) {
    return "they are black; nothing is before the camera, or no light falls on it. Move the camera "
           "(plant/camera_position, plant/camera_look_at), or add a <light>";
  }
  return std::string(*ends.first == *ends.second
                         ? "the camera sees one colour, nothing or a surface "
                           "that fills the image"
                         : "what the camera sees does not move") +
         "; move it (plant/camera_position, plant/camera_look_at)";
}

}  // namespace

void requireVisible(const std::shared_ptr<const MujocoModel>& model, const MujocoOptions& options) {
  constexpr int kPoses = 8;
  constexpr int kDiffers = 4;  // above rounding errors and faint shadows [grey levels]
  const mjModel& m = model->get();
  const MujocoPlant plant(model, options);
  const Mechanism mechanism(model);
  std::mt19937_64 engine(0);
  RenderedImage first;
  try {
    first = plant.render(plant.info().start);
    for (int pose = 0; pose < kPoses; ++pose) {
      const VectorXd state = atRest(mechanism.draw(&engine));
      if (numDifferent(first, plant.render(state), kDiffers) > 0) return;
    }
  } catch (const std::runtime_error&) {
    return;  // OpenGL fails; the first image that is needed reports the reason
  }
  const CameraModel camera = *plant.cameraModel();
  const Eigen::Vector3d center(m.stat.center);
  const double depth = m.vis.map.zfar * m.stat.extent;  // largest distance that MuJoCo draws [m]
  refuseModel("plant/camera must show the motion of ", model->uri(),
              ", but its images are equal in all poses: ", whyUnseen(m, first),
              ". The camera is at ", point(camera.position), ", looks along ",
              point(camera.rotation.col(2)), " and sees ", std::round(camera.fovy * 180.0 / kPi),
              " deg; the middle of the model is at ", point(center), ", its size is ",
              std::round(1e3 * m.stat.extent) / 1e3, " m",
              (camera.position - center).norm() <= depth
                  ? ""
                  : textOf("; nothing farther than ", depth,
                           " m is drawn: correct <statistic extent> or <map zfar> of the file"));
}

PlantCheck checkPlant(const PlantProposal& proposal, const Plant& plant) {
  constexpr int kPoses = 12, kVisible = 8;
  PlantCheck check;
  const auto change = [&](const VectorXd& a, const VectorXd& b) {
    return numDifferent(plant.render(a), plant.render(b), kVisible);
  };
  std::vector<int> pixels;
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    pixels.push_back(change(proposal.poses[i], proposal.poses[i + 1]));
  }
  std::nth_element(pixels.begin(), pixels.begin() + kPoses / 2, pixels.end());
  check.changed_pixels = pixels[kPoses / 2];
  for (std::size_t k = 0; k < proposal.joints.size(); ++k) {
    const ModelJoint& joint = proposal.joints[k];
    int seen = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      VectorXd moved = proposal.poses[i];
      double& position = moved[static_cast<Eigen::Index>(k)];
      const double quarter = 0.25 * (joint.upper - joint.lower);
      position += position + quarter > joint.upper ? -quarter : quarter;
      seen = std::max(seen, change(proposal.poses[i], moved));
    }
    if (seen == 0) check.unseen.push_back(joint.name);
  }
  return check;
}

}  // namespace ddm
