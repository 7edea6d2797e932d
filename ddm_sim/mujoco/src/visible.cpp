// Whether the images of a plant show its motion.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "ddm_mujoco/mujoco_plant.h"
#include "ddm_sim/angles.h"

namespace ddm {
namespace {

std::string point(const Eigen::Vector3d& at) {
  std::ostringstream text;
  const Eigen::Vector3d rounded = (1e3 * at.array()).round() / 1e3 + 0.0;
  text << '(' << rounded[0] << ", " << rounded[1] << ", " << rounded[2] << ')';
  return text.str();
}

/// Whether a pixel differs by more than rounding and shadows of nothing.
bool differ(const Picture& a, const Picture& b) {
  constexpr int kSeen = 3;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) {
    if (std::abs(a.bytes[i] - b.bytes[i]) > kSeen) return true;
  }
  return false;
}

/// The likely cause of images that do not change.
std::string whyUnseen(const mjModel& model, const Picture& picture) {
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
  const auto ends = std::minmax_element(picture.bytes.begin(), picture.bytes.end());
  if (*ends.second < 10) {
    return "they are black; nothing is before the camera, or no light falls on it. Move the camera "
           "(plant/camera_position, plant/camera_look_at), or add a <light>";
  }
  return std::string(*ends.first == *ends.second
                         ? "the camera sees one colour, nothing or a surface "
                           "that fills the image"
                         : "what the camera sees does not move") +
         "; move it (plant/camera_position, plant/camera_look_at, plant/camera_field_of_view)";
}

}  // namespace

void requireVisible(const std::shared_ptr<const MujocoModel>& model, const MujocoOptions& options) {
  constexpr int kPoses = 8;
  const mjModel& m = model->get();
  const MujocoPlant plant(model, options);
  const Eigen::VectorXd& start = plant.info().start;
  std::mt19937_64 engine(0);
  Picture first;
  try {
    first = plant.render(start);
    for (int pose = 0; pose < kPoses; ++pose) {
      Eigen::VectorXd state = start;
      for (int i = 0; i < m.njnt; ++i) {
        const double reach = m.jnt_type[i] == mjJNT_HINGE ? kPi : m.stat.extent;
        const bool limited = m.jnt_limited[i] != 0;
        const double from = limited ? m.jnt_range[2 * i] : start[i] - reach;
        const double to = limited ? m.jnt_range[2 * i + 1] : start[i] + reach;
        state[i] = std::uniform_real_distribution<double>(from, to)(engine);
      }
      if (differ(first, plant.render(state))) return;
    }
  } catch (const std::runtime_error&) {  // who draws, hears it
    return;
  }
  const CameraModel camera = *plant.cameraModel();
  std::ostringstream text;
  text << "plant/camera must show the motion of " << model->uri()
       << ", but its images are equal in all poses: " << whyUnseen(m, first)
       << ". The camera is at " << point(camera.position) << ", looks along "
       << point(camera.rotation.col(2)) << " and sees " << std::round(camera.fovy * 180.0 / kPi)
       << " deg; the middle of the model is at "
       << point(Eigen::Map<const Eigen::Vector3d>(m.stat.center)) << ", its size is "
       << std::round(1e3 * m.stat.extent) / 1e3 << " m";
  const double seen = m.vis.map.zfar * m.stat.extent;
  const Eigen::Vector3d center(m.stat.center);
  if ((camera.position - center).norm() > seen) {
    text << "; nothing farther than " << seen
         << " m is drawn: correct <statistic extent> or <map zfar> of the file";
  }
  throw std::invalid_argument(text.str());
}

}  // namespace ddm
