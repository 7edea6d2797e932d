// A plant that a model file describes: the keys of its YAML block `plant:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/renderer.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// What a model file cannot say. Lists of the state have a number for each joint, or one for each
/// joint and then one for each rate; those of motors have one for each motor.
struct MujocoOptions : PlantOptions {
  std::string model;         ///< MJCF or URDF: a path, or package://PACKAGE/PATH
  std::string model_digest;  ///< of the model and all files that are named; filled in

  double timestep = 0.0;  ///< of MuJoCo [s]; 0: that of the file

  std::vector<std::string> motors;  ///< joints that have a motor; empty: the actuators of the file

  std::vector<double> start;          ///< mean initial state [rad, m]; empty: pose 0 of the file
  std::vector<double> start_uniform;  ///< half-width of a uniform part of the initial state
  std::vector<double> goal;           ///< state to reach and hold [rad, m]; empty: all zero
  std::string goal_site;  ///< site or body that a drawn goal brings to a point of the x-y plane
  std::vector<double> goal_distance;       ///< least and largest distance of that point from 0 [m]
  std::vector<std::string> error_joints;   ///< joints whose error counts; empty: all
  std::vector<std::string> error_sites;    ///< or sites and bodies, whose distance counts
  double tolerance = 0.0;                  ///< largest error at the goal [deg or m]
  std::vector<std::string> visible_sites;  ///< what the oracle method sees; empty: all bodies

  std::vector<std::string> state_names;   ///< columns; empty: by joint and unit
  std::vector<std::string> torque_names;  ///< columns; empty: by joint and unit
  std::string reward;                     ///< one of rewards.h; empty: none
  int episode_frames = 0;                 ///< physics frames of an evaluation; 0: those of a trial

  RenderOptions look;  ///< of the learner's image; its size is picture_size

  MujocoOptions() {
    type = "mujoco";
    max_torque.clear();  // those of the file
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
    visitor("error_joints", error_joints);
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
    visitor("samples", look.samples);
    visitor("supersampling", look.supersampling);
    visitor("camera_shift", look.camera_shift);
    visitor("colour_shift", look.colour_shift);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  /// MujocoPlant checks that they fit the model file.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
