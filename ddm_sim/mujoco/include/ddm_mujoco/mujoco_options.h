// Options of a plant with a MuJoCo model: the keys of its YAML block `plant:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/renderer.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// Properties of a plant that a model file does not contain. A list that describes a state has one
/// number per joint (positions), or one number per joint for the positions and then one per joint
/// for the rates. A list that describes motors has one number per motor.
struct MujocoOptions : PlantOptions {
  std::string model;  ///< MJCF or URDF: a path, or package://PACKAGE/PATH
  /// Checksum of the model file and of all files that it names; completed() fills it in.
  std::string model_digest;

  double timestep = 0.0;  ///< time step of MuJoCo [s]; 0: the time step of the model file

  std::vector<std::string> motors;  ///< joints that have a motor; empty: the actuators of the file

  std::vector<double> start;  ///< mean initial state [rad, m]; empty: qpos0 of the file
  /// Half-width of a uniform part of the initial state [rad, m]
  std::vector<double> start_uniform;
  std::vector<double> goal;  ///< state to reach and hold [rad, m]; empty: all zero
  /// Site or body that the goal state brings to a point of the x-y plane; this point is drawn for
  /// each episode.
  std::string goal_site;
  /// Smallest and largest distance of that point from 0 [m]
  std::vector<double> goal_distance;
  /// Sites and bodies whose distance from the goal is measured. Empty: hinges, or else slides.
  std::vector<std::string> error_sites;
  double tolerance = 0.0;  ///< largest error of a reached goal [deg or m]
  /// Positions that the method oracle gets; empty: all bodies.
  std::vector<std::string> visible_sites;

  std::vector<std::string> state_names;   ///< column names; empty: made from joint and unit
  std::vector<std::string> torque_names;  ///< column names; empty: made from joint and unit
  std::string reward;                     ///< name of a reward in rewards.h; empty: no reward
  int episode_frames = 0;                 ///< physics steps of an evaluation; 0: as long as a trial

  RenderOptions look;  ///< how the learner's image is drawn; its size is image_size

  MujocoOptions() {
    type = "mujoco";
    max_torque.clear();  // empty: the limits of the model file
  }

  template <class Visitor>
  void visit(Visitor& visitor) {
    PlantOptions::visit(visitor);
    visitor("model", model);
    visitor("model_digest", model_digest);
    visitor("timestep", timestep);
    visitor("motors", motors);
    visitor("start", start);
    visitor("start_uniform", start_uniform);
    visitor("goal", goal);
    visitor("goal_site", goal_site);
    visitor("goal_distance", goal_distance);
    visitor("error_sites", error_sites);
    visitor("tolerance", tolerance);
    visitor("visible_sites", visible_sites);
    visitor("state_names", state_names);
    visitor("torque_names", torque_names);
    visitor("reward", reward);
    visitor("episode_frames", episode_frames);
    visitor("camera", look.camera);
    visitor("camera_position", look.position);
    visitor("camera_look_at", look.look_at);
    visitor("colour", look.colour);
    visitor("supersampling", look.supersampling);
  }

  /// All problems with these values, in words that a user can act on. Empty means valid. The
  /// constructor of MujocoPlant checks that the options fit the model file.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
