// Parameters of the plants, the camera and the simulator; one struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace ddm {

class PlantMaker;

/// The keys of the block `plant:` that every plant has.
struct PlantBasics {
  std::string type = "pendulum";  ///< which plant, see plantTypes(); PACKAGE/CLASS is a plugin
  double max_torque = 6.0;        ///< bound on each |u| [N m]; moving_tile: [pixels]
  double dt = 0.2;                ///< time step, u is held constant over it [s]
  double start_std = 0.1;         ///< standard deviation of each component of the start state

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("type", type);
    visitor("max_torque", max_torque);
    visitor("dt", dt);
    visitor("start_std", start_std);
  }

  /// Everything wrong with these values, in words a user can act on, but for `type`.
  std::vector<std::string> problems() const;
};

/// Parameters of the plant. YAML block `plant:`.
struct PlantOptions : PlantBasics {
  double gravity = 0.0;        ///< pendulum: g [m/s^2]. The paper's published runs fit 0
  double length = 1.0;         ///< pendulum: l, length of the rod [m]
  double mass = 1.0;           ///< pendulum: m, mass of the rod [kg]
  double friction = 1.0;       ///< pendulum: b, viscous friction [N m s/rad]
  double tile_width = 9.0;     ///< moving_tile: width and height of the tile [pixels]
  double tile_softness = 9.0;  ///< moving_tile: grey falls from 1 to 0 over so much [pixels]

  /// Makes the plant of another package, whose own keys it holds; null for those of plantTypes().
  std::shared_ptr<const PlantMaker> maker;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("type", type);
    visitor("gravity", gravity);
    visitor("length", length);
    visitor("mass", mass);
    visitor("friction", friction);
    visitor("tile_width", tile_width);
    visitor("tile_softness", tile_softness);
    visitor("max_torque", max_torque);
    visitor("dt", dt);
    visitor("start_std", start_std);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// The values that `plant/type` may have.
std::vector<std::string> plantTypes();

/// Parameters of the camera and of what it sees. YAML block `camera:`.
struct CameraOptions {
  int size = 51;                ///< width and height of the image [pixels]
  double half_extent = 1.2;     ///< from the image centre to its edge [m]
  double rod_half_width = 0.1;  ///< half the width of the rod [m]
  double edge_softness = 0.2;   ///< width over which grey falls from 1 to 0 [m]

  // Nuisances, see Camera. All 0: a perfect camera.
  double noise_std = 0.0;           ///< standard deviation of each pixel in each frame [grey]
  double brightness_drift = 0.0;    ///< amplitude of a slow change of brightness [-]
  double brightness_period = 20.0;  ///< period of that change [s]
  double clutter = 0.0;             ///< largest grey value of a static background [grey]
  int clutter_seed = 0;             ///< which background
  int delay = 0;                    ///< so many frames late [-]
  double drop_rate = 0.0;           ///< probability that a frame is lost [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("size", size);
    visitor("half_extent", half_extent);
    visitor("rod_half_width", rod_half_width);
    visitor("edge_softness", edge_softness);
    visitor("noise_std", noise_std);
    visitor("brightness_drift", brightness_drift);
    visitor("brightness_period", brightness_period);
    visitor("clutter", clutter);
    visitor("clutter_seed", clutter_seed);
    visitor("delay", delay);
    visitor("drop_rate", drop_rate);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Parameters of sim_node: how simulated time passes. YAML block `sim:`.
struct SimOptions {
  bool lockstep = true;   ///< true: an image waits for its torque; false: real time
  double watchdog = 5.0;  ///< lock-step: wall time that a torque may take [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("lockstep", lockstep);
    visitor("watchdog", watchdog);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// All problems of the two blocks that make a plant.
std::vector<std::string> problemsOf(const PlantOptions& plant, const CameraOptions& camera);

/// @throws std::invalid_argument with all of the problems, one a line, if there are any
void requireNone(const std::vector<std::string>& problems);

}  // namespace ddm
