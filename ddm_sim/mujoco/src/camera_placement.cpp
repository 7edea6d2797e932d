// Finds a camera position from which all poses of a model are visible.
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "ddm_mujoco/renderer.h"
#include "ddm_sim/plant.h"
#include "mechanism.h"

namespace ddm {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kMargin = 0.06;  // margin on each side, in halves of the image [-]
// A direction this close to the largest share of visible motion is tried, too [-]
constexpr double kAlmostBest = 0.05;
constexpr std::size_t kMaxTried = 6;  // largest number of directions from which images are drawn

/// Half the sides of the box around a geom, in the frame of the geom [m].
Vector3d halfSides(const mjModel& m, int geom) {
  const Vector3d size(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return Vector3d::Constant(size[0]);
    case mjGEOM_CAPSULE:
      return {size[0], size[0], size[0] + size[1]};
    case mjGEOM_CYLINDER:
      return {size[0], size[0], size[1]};
    default:
      return size;  // of a box, an ellipsoid, or the box around a mesh
  }
}

/// Drawn geoms that a joint can move.
std::vector<int> movingGeoms(const mjModel& m) {
  std::vector<int> geoms;
  for (int i = 0; i < m.ngeom; ++i) {
    if (isDrawnAndMoves(m, i)) geoms.push_back(i);
  }
  return geoms;
}

/// For each direction: share of a joint's motion that is visible, minimum over all joints
/// [directions x 1].
Eigen::VectorXd motionSeen(const mjModel& m, const Mechanism& mechanism,
                           const std::vector<Eigen::VectorXd>& poses,
                           const std::vector<Vector3d>& directions) {
  const auto num_directions = static_cast<Eigen::Index>(directions.size());
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(num_directions, m.njnt);
  Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(m.njnt);
  const std::vector<int> geoms = movingGeoms(m);
  // Velocity of a corner for a rate of 1 of each joint.
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor> velocities(3, m.njnt);
  for (const Eigen::VectorXd& pose : poses) {
    const mjData& data = mechanism.place(pose);
    const Matrix3Xd corners = movingCorners(m, data);
    for (Eigen::Index i = 0; i < corners.cols(); ++i) {
      const int body = m.geom_bodyid[geoms[static_cast<std::size_t>(i / 8)]];
      mj_jac(&m, &data, velocities.data(), nullptr, corners.col(i).data(), body);
      for (int joint = 0; joint < m.njnt; ++joint) {
        const Vector3d velocity = velocities.col(joint);
        all[joint] += velocity.norm();
        for (Eigen::Index k = 0; k < num_directions; ++k) {
          seen(k, joint) += velocity.cross(directions[static_cast<std::size_t>(k)]).norm();
        }
      }
    }
  }
  const Eigen::RowVectorXd scale = (all.array() > 0.0).select(all.cwiseInverse(), 0.0);
  return (seen * scale.asDiagonal()).rowwise().minCoeff();
}

/// Unit vectors from the model to possible cameras: along the axes of the world and of the joints,
/// then from 30 and 60 degrees above the horizon.
std::vector<Vector3d> directionsOf(const mjModel& m, const mjData& placed) {
  std::vector<Vector3d> directions = {{0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < m.njnt; ++i) {
    Vector3d axis = Eigen::Map<const Vector3d>(placed.xaxis + 3 * i);
    axis = (axis.array().abs() < 1e-3).select(0.0, axis).normalized();
    for (const Vector3d& one : {axis, Vector3d(-axis)}) {
      if (one.z() >= -0.5) directions.push_back(one);  // not from below
    }
  }
  for (const double elevation : {30.0, 60.0}) {
    for (const double azimuth : {-90.0, -45.0, -135.0, 0.0, 180.0, 45.0, 135.0, 90.0}) {
      const double up = elevation * kPi / 180.0, around = azimuth * kPi / 180.0;
      directions.emplace_back(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around),
                              std::sin(up));
    }
  }
  return directions;
}

/// Rounds a point to about a thousandth of the distance, so that people can read the numbers.
Vector3d rounded(const Vector3d& point, double distance) {
  const double unit = std::pow(10.0, std::floor(std::log10(distance)) - 3.0);
  return (point / unit).array().round() * unit;
}

/// Returns `look` with a camera in this direction from the model, at the distance at which all
/// corners fit into the image with a margin.
RenderOptions lookFrom(const Vector3d& direction, const Matrix3Xd& corners, RenderOptions look) {
  const bool vertical = direction.head<2>().isZero();
  const Vector3d above = vertical ? Vector3d::UnitY() : Vector3d::UnitZ();
  Eigen::Matrix3d axes;  // rows: right, up and towards the camera
  axes.row(0) = above.cross(direction).normalized();
  axes.row(1) = direction.cross(axes.row(0).transpose());
  axes.row(2) = direction;
  Matrix3Xd seen = axes * corners;
  const Vector3d middle = 0.5 * (seen.rowwise().minCoeff() + seen.rowwise().maxCoeff());
  seen.colwise() -= middle;
  const double widest = (1.0 - kMargin) * std::tan(0.5 * RenderOptions::kFieldOfView * kPi / 180.0);
  const Eigen::RowVectorXd reach = seen.topRows(2).cwiseAbs().colwise().maxCoeff();
  const double distance = std::max(1e-3, (reach / widest + seen.row(2)).maxCoeff());
  const Vector3d look_at = rounded(axes.transpose() * middle, distance);
  const Vector3d position = look_at + rounded(distance * direction, distance);
  look.position = {position.x(), position.y(), position.z()};
  look.look_at = {look_at.x(), look_at.y(), look_at.z()};
  return look;
}

/// Standard deviation of each pixel over several poses, averaged over all pixels.
double changeOfImages(const std::shared_ptr<const MujocoModel>& model, const Mechanism& mechanism,
                      const std::vector<Eigen::VectorXd>& poses, const RenderOptions& look) {
  constexpr int kPoses = 8;
  Renderer renderer(model, look);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(look.width * look.height), squares = sum;
  for (int i = 0; i < kPoses; ++i) {
    const RenderedImage rendered =
        renderer.draw(mechanism.place(poses[static_cast<std::size_t>(i)]));
    const Eigen::ArrayXd pixels = Eigen::Map<const Eigen::Array<std::uint8_t, Eigen::Dynamic, 1>>(
                                      rendered.bytes.data(), sum.size())
                                      .cast<double>();
    sum += pixels;
    squares += pixels.square();
  }
  return (squares / kPoses - (sum / kPoses).square()).max(0.0).sqrt().mean();
}

}  // namespace

Matrix3Xd movingCorners(const mjModel& m, const mjData& placed) {
  const std::vector<int> geoms = movingGeoms(m);
  Matrix3Xd corners(3, 8 * static_cast<Eigen::Index>(geoms.size()));
  Eigen::Index column = 0;
  for (const int geom : geoms) {
    const Vector3d half = halfSides(m, geom);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(placed.geom_xmat +
                                                                              9 * geom);
    const Vector3d middle = Eigen::Map<const Vector3d>(placed.geom_xpos + 3 * geom);
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                           (corner & 4) != 0 ? 1 : -1);
      corners.col(column++) = middle + axes * half.cwiseProduct(signs);
    }
  }
  return corners;
}

RenderOptions placedCamera(const std::shared_ptr<const MujocoModel>& model,
                           const Mechanism& mechanism, const std::vector<Eigen::VectorXd>& poses,
                           const RenderOptions& look) {
  const mjModel& m = model->get();
  Matrix3Xd corners;
  for (const Eigen::VectorXd& pose : poses) {
    const Matrix3Xd here = movingCorners(m, mechanism.place(pose));
    corners.conservativeResize(3, corners.cols() + here.cols());
    corners.rightCols(here.cols()) = here;
  }
  if (corners.cols() == 0) {
    refuseModel(
        model->uri(),
        " has no shape that a joint moves and that is not transparent, so no image could show its "
        "pose: give the moving links a <visual>, the moving bodies a <geom>");
  }
  const std::vector<Vector3d> directions = directionsOf(m, mechanism.place(poses.front()));
  const Eigen::VectorXd seen = motionSeen(m, mechanism, poses, directions);
  RenderOptions best;
  double most = -1.0;
  std::size_t tried = 0;
  for (std::size_t i = 0; i < directions.size() && tried < kMaxTried; ++i) {
    if (seen[static_cast<Eigen::Index>(i)] < seen.maxCoeff() - kAlmostBest) continue;
    ++tried;
    const RenderOptions from_here = lookFrom(directions[i], corners, look);
    const double shown = changeOfImages(model, mechanism, poses, from_here);
    // Earlier directions are more usual: a later one must be clearly better.
    if (shown <= 1.1 * most) continue;
    most = shown;
    best = from_here;
  }
  return best;
}

}  // namespace ddm
