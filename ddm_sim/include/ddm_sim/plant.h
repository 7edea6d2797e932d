// A plant: something that takes a torque, moves for one time step and is seen by a camera.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace ddm {

/// The plant that a policy controls; the paper's "system" behind the pixels.
///
///   state_{t+1} = advance(state_t, clamp(u_t, -max_torque, max_torque)),   u held constant over dt
///
/// "Torque" is the word for what acts, whatever the plant: of the pendulum it is one [N m], of the
/// moving tile they are two increments of position [pixels]. Units of states and torques are the
/// plant's own; stateNames() and torqueNames() tell them.
///
/// The state is the vector of joint positions, followed by that of their rates if the plant has
/// them: its first jointNames().size() entries are the positions. It serves evaluation alone; what
/// a policy sees is a Camera's photograph. Checks of sizes and finiteness, and the saturation,
/// stand here once, so that an implementation holds nothing but its physics and its picture.
class Plant {
 public:
  virtual ~Plant() = default;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  int stateDim() const { return static_cast<int>(state_.size()); }
  int torqueDim() const { return torque_dim_; }
  double dt() const { return dt_; }                 ///< time step [s]
  double maxTorque() const { return max_torque_; }  ///< bound on every component of |u|

  /// State now, at first the middle of the start states                          [stateDim() x 1]
  const Eigen::VectorXd& state() const { return state_; }

  /// Takes `state` exactly, digit by digit.
  /// @throws std::invalid_argument if it is not [stateDim() x 1] or not finite; nothing has changed
  void setState(const Eigen::VectorXd& state);

  /// A start state of a trial: N(0, start_std^2) in each component, around the middle of the start
  /// states. Does not set it. The draw is fixed for libstdc++; other standard libraries implement
  /// std::normal_distribution differently.
  /// @return state                                                               [stateDim() x 1]
  Eigen::VectorXd drawStart(std::mt19937_64& engine) const;

  /// Moves by dt under a constant torque.
  /// @param torque  u, saturated at +-maxTorque() in each component             [torqueDim() x 1]
  /// @return the torque as it was applied, i.e. after the saturation            [torqueDim() x 1]
  /// @throws std::invalid_argument if it is not [torqueDim() x 1] or not finite
  /// @throws std::range_error if the state would leave the range of double
  /// @throws std::logic_error if advance() returns another number of components. In each case
  ///         nothing has changed
  Eigen::VectorXd step(const Eigen::VectorXd& torque);

  /// The state that a policy is to reach and hold                                [stateDim() x 1]
  virtual Eigen::VectorXd goalState() const = 0;

  /// Distance of the position in `state` to the goal, >= 0, in the unit of the position. A plant
  /// with an angle: [rad], the short way round, thus in [0, pi].
  /// @throws std::invalid_argument as setState()
  double goalError(const Eigen::VectorXd& state) const;

  /// A perfect camera's picture of `state`: rows from top to bottom, k = round(255 grey), grey in
  /// [0, 1].
  /// @return bytes                                                    [imageSize() * imageSize()]
  /// @throws std::invalid_argument as setState()
  /// @throws std::logic_error if draw() returns another number of bytes
  std::vector<std::uint8_t> render(const Eigen::VectorXd& state) const;

  /// How much of each pixel of render() the plant covers, 255: all of it. There it hides what lies
  /// behind it, however dark it is.
  /// @return bytes; none if the plant does not say               [imageSize() * imageSize()] or [0]
  /// @throws as render()
  std::vector<std::uint8_t> coverage(const Eigen::VectorXd& state) const;

  /// Where the part that moves is in the picture: what a learner can know of `state` from one
  /// image. Origin, directions and unit are the plant's own: the pendulum gives the tip of its rod
  /// [m], the moving tile its centre [pixels].
  /// @return (x, y)                                                                        [2 x 1]
  /// @throws std::invalid_argument as setState()
  Eigen::VectorXd visiblePosition(const Eigen::VectorXd& state) const;

  /// The positions are angles [rad], and goalError() with them.
  virtual bool turns() const = 0;

  virtual int imageSize() const = 0;  ///< width and height of the picture [pixels]
  virtual std::vector<std::string> jointNames() const = 0;

  /// Names of the components of a state with their units, as the headers of CSV files have them:
  /// "angle_rad".                                                                   [stateDim()]
  virtual std::vector<std::string> stateNames() const = 0;

  /// The same for a torque: "torque_nm".                                           [torqueDim()]
  virtual std::vector<std::string> torqueNames() const = 0;

 protected:
  /// @param start       middle of the start states                               [stateDim() x 1]
  /// @param torque_dim  number of motors
  /// @param dt          time step [s]
  /// @param max_torque  bound on every component of |u|
  /// @param start_std   standard deviation of each component of a start state
  Plant(Eigen::VectorXd start, int torque_dim, double dt, double max_torque, double start_std);

 private:
  /// The physics: the state dt after `state`. Sizes and finiteness are checked, torque saturated.
  virtual Eigen::VectorXd advance(const Eigen::VectorXd& state,
                                  const Eigen::VectorXd& torque) const = 0;
  virtual double distanceToGoal(const Eigen::VectorXd& state) const = 0;
  virtual std::vector<std::uint8_t> draw(const Eigen::VectorXd& state) const = 0;

  /// coverage(): at least draw() in each pixel, since what is not covered is black there. A plant
  /// that is white on black returns draw(), one that fills its picture 255 everywhere.
  virtual std::vector<std::uint8_t> cover(const Eigen::VectorXd& /*state*/) const { return {}; }
  virtual Eigen::VectorXd locate(const Eigen::VectorXd& state) const = 0;  ///< visiblePosition()

  std::size_t numPixels() const;  ///< of a picture

  Eigen::VectorXd start_;
  Eigen::VectorXd state_;
  int torque_dim_;
  double dt_;
  double max_torque_;
  double start_std_;
};

/// Random stream of the start states: fixed by its arguments, another one for each trial and for
/// the greedy evaluation after it, and independent of the streams of all other roles.
/// @param seed        seed of the experiment
/// @param trial       number of the trial, 0 is the random one
/// @param evaluation  the greedy run after `trial`
std::mt19937_64 startStream(std::uint64_t seed, std::uint32_t trial, bool evaluation);

}  // namespace ddm
