// A plant: takes a torque, moves for one time step, and can be seen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ddm_sim/picture.h"

namespace ddm {

enum class JointKind { kAngle, kLength };

struct Joint {
  std::string name;  ///< in ground_truth/joint_states
  JointKind kind = JointKind::kAngle;
};

/// What a plant says of itself; columns, limits, units and success follow from it.
struct PlantInfo {
  std::string type = "of a test";  ///< plant/type, for messages; makePlant() fills it in

  std::vector<Joint> joints;  ///< in the order of their positions in the state

  /// Components of a state with their units, the headers of CSV files: "angle_rad". Positions come
  /// first, one for each joint, then their rates if the plant has them.              [stateDim()]
  std::vector<std::string> state_names;

  std::vector<std::string> torque_names;  ///< the same for a torque: "torque_nm"  [torqueDim()]
  Eigen::VectorXd max_torque;  ///< bound on each |u|, in the unit of its name [torqueDim() x 1]
  double dt = 0.2;             ///< time step [s]
  Eigen::VectorXd start;       ///< middle of the start states                 [stateDim() x 1]
  Eigen::VectorXd start_std;   ///< standard deviation of each component       [stateDim() x 1]
  Eigen::VectorXd goal;        ///< state to reach and hold                    [stateDim() x 1]
  std::string error_unit;      ///< unit of Plant::goalError(): "deg", "m", "px"
  double tolerance = 0.0;      ///< the goal is reached where goalError() is at most this
  int evaluation_steps = 0;    ///< time steps of a greedy run; 0: as many as a trial has

  int stateDim() const { return static_cast<int>(state_names.size()); }
  int torqueDim() const { return static_cast<int>(torque_names.size()); }
};

/// The plant that a policy controls; the paper's "system" behind the pixels.
///
///   state_{t+1} = advance(state_t, clamp(u_t, -max_torque, max_torque)),   u held constant over dt
///
/// "Torque" is the word for every input of a plant: the pendulum has one [N m], the moving tile two
/// increments of position [pixels]. PlantInfo has the units.
///
/// The state serves evaluation alone; a policy sees pictures. This class checks sizes and
/// finiteness and saturates torques, so that a derived class holds its physics and its picture and
/// nothing else.
class Plant {
 public:
  virtual ~Plant() = default;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  const PlantInfo& info() const { return info_; }
  void setType(const std::string& type) { info_.type = type; }
  int stateDim() const { return info_.stateDim(); }
  int torqueDim() const { return info_.torqueDim(); }

  /// State now, at first the middle of the start states                          [stateDim() x 1]
  const Eigen::VectorXd& state() const { return state_; }

  /// Takes `state` exactly, digit by digit.
  /// @throws std::invalid_argument if it is not [stateDim() x 1] or not finite; nothing has changed
  void setState(const Eigen::VectorXd& state);

  /// The state to reach and hold in this trial, at first info().goal             [stateDim() x 1]
  const Eigen::VectorXd& goal() const { return goal_; }

  /// @throws std::invalid_argument as setState()
  void setGoal(const Eigen::VectorXd& goal);

  /// A start state of a trial; does not set it. By default N(start, start_std^2) in each component.
  /// Draws are fixed for libstdc++; other standard libraries implement distributions differently.
  /// @return state                                                               [stateDim() x 1]
  virtual Eigen::VectorXd drawStart(std::mt19937_64& engine) const;

  /// The goal of a trial; does not set it. By default the same in all trials, info().goal.
  /// @return state                                                               [stateDim() x 1]
  virtual Eigen::VectorXd drawGoal(std::mt19937_64& engine) const;

  /// Moves by dt under a constant torque.
  /// @param torque  u, saturated at +-max_torque                                [torqueDim() x 1]
  /// @return the torque as it was applied, after the saturation                 [torqueDim() x 1]
  /// @throws std::invalid_argument if it is not [torqueDim() x 1] or not finite
  /// @throws std::range_error if the state would not be finite
  /// @throws std::logic_error if advance() returns another number of components. In each case
  ///         nothing has changed
  Eigen::VectorXd step(const Eigen::VectorXd& torque);

  /// Distance of `state` to goal(), >= 0 [info().error_unit].
  /// @throws std::invalid_argument as setState()
  double goalError(const Eigen::VectorXd& state) const;

  /// The goal of a run that is to reach this place, for plants that draw their goals as such: a
  /// target, from which the state to reach follows. Does not set it.
  /// @param target  what and in which unit is the plant's own: the reacher has x, y [m]
  /// @throws std::invalid_argument if this plant has no targets, or cannot reach this one
  virtual Eigen::VectorXd goalAt(const Eigen::VectorXd& target) const;

  /// Reward of one frame of the physics, for reports; nothing learns from it. Empty: the plant has
  /// none.
  /// @param state   that the frame has led to                                    [stateDim() x 1]
  /// @param torque  as it was applied in this frame                             [torqueDim() x 1]
  virtual std::optional<double> reward(const Eigen::VectorXd& state,
                                       const Eigen::VectorXd& torque) const;

  /// Sum of the rewards of all frames of the steps that start in `state`, under one torque.
  /// @param torque     as for step()                                            [torqueDim() x 1]
  /// @param num_steps  more than one where frames that a camera would have seen are lost
  /// @throws as step()
  std::optional<double> stepReward(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                                   int num_steps = 1) const;

  /// What a perfect camera sees of `state`; always of the same size.
  /// @throws std::invalid_argument as setState()
  /// @throws std::logic_error if draw() returns another number of bytes than its size says
  Picture render(const Eigen::VectorXd& state) const;

  /// The camera of render() now; empty: it is none that a lens could be.
  virtual std::optional<CameraModel> cameraModel() const { return std::nullopt; }

  /// The camera of view(); empty: there is no view.
  virtual std::optional<CameraModel> viewModel() const { return std::nullopt; }

  /// A large picture of `state` for people, where viewModel() says that there is one.
  /// @throws std::invalid_argument as setState(); std::logic_error if there is none
  virtual Picture view(const Eigen::VectorXd& state) const;

  /// Where the moving parts are in the picture: what a learner can know of `state` from one image.
  /// Origin, directions and unit are the plant's own: the pendulum gives the tip of its rod [m].
  /// @return coordinates, always as many                                                   [n x 1]
  /// @throws std::invalid_argument as setState()
  Eigen::VectorXd visiblePosition(const Eigen::VectorXd& state) const;

 protected:
  explicit Plant(PlantInfo info);

 private:
  /// The physics: the state dt after `state`. Sizes and finiteness are checked, torque saturated.
  virtual Eigen::VectorXd advance(const Eigen::VectorXd& state,
                                  const Eigen::VectorXd& torque) const = 0;

  /// stepReward() of a plant with rewards: by default that of one frame, which the step is.
  virtual double rewardOfStep(const Eigen::VectorXd& state, const Eigen::VectorXd& torque) const;
  virtual double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const = 0;
  virtual Picture draw(const Eigen::VectorXd& state) const = 0;
  virtual Eigen::VectorXd locate(const Eigen::VectorXd& state) const = 0;

  Eigen::VectorXd saturated(const Eigen::VectorXd& torque) const;

  PlantInfo info_;
  Eigen::VectorXd state_;
  Eigen::VectorXd goal_;
};

/// Random stream of the start states: fixed by its arguments, another one for each trial and for
/// the greedy evaluation after it, and independent of the streams of all other roles.
/// @param seed        seed of the experiment
/// @param trial       number of the trial, 0 is the random one
/// @param evaluation  the greedy run after `trial`
std::mt19937_64 startStream(std::uint64_t seed, std::uint32_t trial, bool evaluation);

/// The goal of a run, drawn from a stream of its own; arguments as above.
Eigen::VectorXd goalOf(const Plant& plant, std::uint64_t seed, std::uint32_t trial,
                       bool evaluation);

/// Makes plants of one kind, with the options that it holds.
class PlantMaker {
 public:
  virtual ~PlantMaker() = default;

  virtual std::string type() const = 0;  ///< `plant/type`, for messages

  /// @throws std::invalid_argument if the options do not fit together
  virtual std::unique_ptr<Plant> make() const = 0;
};

/// A plant in the middle of its start states. Its PlantInfo must have
///
///   - as many names, limits, starts and goals as components, 1 to 1000 of each, all finite; names
///     differ and have neither blanks nor commas nor quotes, since they head columns
///   - no more joints than components of the state, and at least one
///   - dt > 0, limits > 0, start_std >= 0, tolerance > 0, and an error_unit
///
/// Class Plant checks what the plant returns while it runs. test/every_plant_test.cpp tests all other
/// rules, also of a plant of another package.
/// @throws std::invalid_argument with the problems of the options, or with the type and all rules
///         that its plant breaks
std::unique_ptr<Plant> makePlant(const PlantMaker& maker);

/// Whether a name can head a column of CSV files: neither blanks nor commas nor quotes, ASCII alone.
bool usableName(const std::string& name);

/// "[1 2 3]", of many the first ten: a million of them, sent by mistake, must not fill the logs.
std::string fewNumbers(const Eigen::VectorXd& numbers);

}  // namespace ddm
