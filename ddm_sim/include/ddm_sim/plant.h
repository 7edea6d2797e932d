// The interface of a plant: the plant moves under a torque and has a rendered image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/random_stream.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ddm_sim/rendered_image.h"

namespace ddm {

enum class JointKind { kAngle, kLength };

/// A joint of a plant: an angle [rad] or a length [m].
struct Joint {
  std::string name;  ///< name in ground_truth/joint_states
  JointKind kind = JointKind::kAngle;
};

/// Description of a plant. CSV columns, torque limits, units and the success criterion follow from
/// it.
struct PlantInfo {
  std::string type = "of a test";  ///< value of plant/type, for messages; checkedPlant() sets it

  std::vector<Joint> joints;  ///< in the order of their positions in the state

  /// Names of the components of a state with their units, such as "angle_rad"; they are also the
  /// column names of CSV files. Positions come first, one for each joint, then their rates if the
  /// state has rates.                                                                  [stateDim()]
  std::vector<std::string> state_names;

  /// Names of the components of a torque, such as "torque_nm" [torqueDim()]
  std::vector<std::string> torque_names;
  Eigen::VectorXd max_torque;  ///< bound on each |u|, in the unit of its name [torqueDim() x 1]
  double dt = 0.2;             ///< time step [s]
  Eigen::VectorXd start;       ///< mean of the initial states [stateDim() x 1]
  /// Standard deviation of each component of the initial state [stateDim() x 1]
  Eigen::VectorXd start_std;
  Eigen::VectorXd goal;      ///< state to reach and to hold [stateDim() x 1]
  std::string error_unit;    ///< unit of Plant::goalError(): "deg", "m", "px"
  double tolerance = 0.0;    ///< success: goalError() is at most this value [error_unit]
  int evaluation_steps = 0;  ///< time steps of an evaluation; 0: the length of a trial

  int stateDim() const { return static_cast<int>(state_names.size()); }
  int torqueDim() const { return static_cast<int>(torque_names.size()); }
};

/// The plant that a policy controls (the "system" of the paper).
///
///   state_{t+1} = advance(state_t, clamp(u_t, -max_torque, max_torque)),   u held constant over dt
///
/// "Torque" is the name of every input of a plant: the pendulum has one torque [N m], the moving
/// tile has two increments of position [pixels]. PlantInfo contains the units.
///
/// The state is used for evaluation only; a policy receives images. The base class checks sizes and
/// finiteness and saturates torques, so a derived class contains only its equations of motion and
/// its renderer.
class Plant {
 public:
  virtual ~Plant() = default;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  const PlantInfo& info() const { return info_; }
  int stateDim() const { return info_.stateDim(); }
  int torqueDim() const { return info_.torqueDim(); }

  /// The current state; the mean of the initial states before the first call of setState() or
  /// step().                                                                       [stateDim() x 1]
  const Eigen::VectorXd& state() const { return state_; }

  /// Sets the state exactly, without rounding.
  /// @throws std::invalid_argument if `state` is not [stateDim() x 1] or not finite; the state is
  ///         then unchanged
  void setState(const Eigen::VectorXd& state);

  /// The state to reach and to hold in this episode; info().goal before the first call of
  /// setGoal().                                                                    [stateDim() x 1]
  const Eigen::VectorXd& goal() const { return goal_; }

  /// Sets the goal state of this episode.
  /// @throws std::invalid_argument as setState()
  void setGoal(const Eigen::VectorXd& goal);

  /// Draws an initial state of an episode and leaves the state of the plant unchanged. The default
  /// implementation draws each component from N(start, start_std^2). The draws are reproducible for
  /// libstdc++ only, because other standard libraries implement the distributions differently.
  /// @return initial state                                                         [stateDim() x 1]
  virtual Eigen::VectorXd drawStart(std::mt19937_64& engine) const;

  /// Draws the goal of an episode and leaves the goal of the plant unchanged. The default
  /// implementation returns info().goal.
  /// @return goal state                                                            [stateDim() x 1]
  virtual Eigen::VectorXd drawGoal(std::mt19937_64& engine) const;

  /// Moves the plant by dt under a constant torque.
  /// @param torque  u, saturated at +-max_torque                                  [torqueDim() x 1]
  /// @return the applied torque, after the saturation                             [torqueDim() x 1]
  /// @throws std::invalid_argument if `torque` is not [torqueDim() x 1] or not finite
  /// @throws std::range_error if the next state would not be finite
  /// @throws std::logic_error if advance() returns another number of components
  /// After an exception the state is unchanged.
  Eigen::VectorXd step(const Eigen::VectorXd& torque);

  /// Distance from `state` to goal(), >= 0 [info().error_unit].
  /// @throws std::invalid_argument as setState()
  double goalError(const Eigen::VectorXd& state) const;

  /// The goal state that belongs to a target, for plants that draw targets and derive the goal
  /// state from them. The goal of the plant is unchanged.
  /// @param target  defined by the plant: the reacher uses (x, y) of its finger [m]
  /// @throws std::invalid_argument if the plant has no targets or cannot reach this target
  virtual Eigen::VectorXd goalAt(const Eigen::VectorXd& target) const;

  /// Reward of one physics step. Rewards are reported, and no learning method uses them. Empty if
  /// the plant has no reward.
  /// @param state   state after the physics step                                   [stateDim() x 1]
  /// @param torque  torque that was applied in the physics step                   [torqueDim() x 1]
  virtual std::optional<double> reward(const Eigen::VectorXd& state,
                                       const Eigen::VectorXd& torque) const;

  /// Sum of the rewards of all physics steps of `num_steps` time steps that begin in `state`, under
  /// a constant torque.
  /// @param torque     saturated as in step()                                     [torqueDim() x 1]
  /// @param num_steps  > 1 if the camera loses the images in between
  /// @throws as step()
  std::optional<double> stepReward(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                                   int num_steps = 1) const;

  /// Renders the image of `state` without any disturbance. The size is always the same.
  /// @throws std::invalid_argument as setState()
  /// @throws std::logic_error if draw() returns a number of bytes that does not match its size
  RenderedImage render(const Eigen::VectorXd& state) const;

  /// The camera of render(). Empty if the renderer has no pinhole model.
  virtual std::optional<CameraModel> cameraModel() const { return std::nullopt; }

  /// The camera of view(). Empty if the plant has no view.
  virtual std::optional<CameraModel> viewModel() const { return std::nullopt; }

  /// Renders a large image of `state` for people. Only plants with a viewModel() have one.
  /// @throws std::invalid_argument as setState()
  /// @throws std::logic_error if the plant has no view
  virtual RenderedImage view(const Eigen::VectorXd& state) const;

  /// Positions of the moving parts in the image: the part of `state` that a single image shows. The
  /// plant defines origin, directions and unit: the pendulum returns the tip of its rod [m].
  /// @return coordinates, the same number for every state                                   [n x 1]
  /// @throws std::invalid_argument as setState()
  Eigen::VectorXd visiblePosition(const Eigen::VectorXd& state) const;

 protected:
  explicit Plant(PlantInfo info);

 private:
  /// Equations of motion: returns the state dt after `state`. The caller has checked sizes and
  /// finiteness and has saturated the torque.
  virtual Eigen::VectorXd advance(const Eigen::VectorXd& state,
                                  const Eigen::VectorXd& torque) const = 0;

  /// Sum of the rewards of one time step. The default implementation treats the time step as one
  /// physics step.
  virtual double rewardOfStep(const Eigen::VectorXd& state, const Eigen::VectorXd& torque) const;

  /// The error of `state` relative to `goal`, see goalError().
  virtual double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const = 0;

  /// The image of `state`, see render().
  virtual RenderedImage draw(const Eigen::VectorXd& state) const = 0;

  /// The positions of the moving parts, see visiblePosition().
  virtual Eigen::VectorXd locate(const Eigen::VectorXd& state) const = 0;

  Eigen::VectorXd saturated(const Eigen::VectorXd& torque) const;
  friend std::unique_ptr<Plant> checkedPlant(std::unique_ptr<Plant> plant, const std::string& type);

  PlantInfo info_;
  Eigen::VectorXd state_;
  Eigen::VectorXd goal_;
};

/// Draws the goal of an episode from a random stream of its own.
Eigen::VectorXd goalOf(const Plant& plant, const TrialId& id);

/// Returns a plant after a check of its PlantInfo. The rules are:
///
/// - The numbers of names, limits, initial values and goal values equal the number of components,
///   which is 1 to 1000. All values are finite. Names differ and contain no blanks, commas or
///   quotes, because they are column names.
/// - The number of joints is at least one and at most the number of components of the state.
/// - dt > 0, max_torque > 0, start_std >= 0, tolerance > 0, and error_unit is not empty.
///
/// Class Plant checks the values that the plant returns while it runs. test/every_plant_test.cpp
/// tests all other rules and can also test a plant of another package.
/// @param type  value of `plant/type`, for messages
/// @throws std::invalid_argument with the type and all rules that the plant breaks
std::unique_ptr<Plant> checkedPlant(std::unique_ptr<Plant> plant, const std::string& type);

constexpr double kPi = 3.14159265358979323846;

/// Absolute difference of two angles [rad], measured along the shorter arc, in [0, 180] deg.
inline double degreesBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * kPi)) * 180.0 / kPi;
}

/// Whether a name can be a column name of a CSV file: ASCII characters without blanks, commas and
/// quotes.
bool usableName(const std::string& name);

/// Formats numbers as "[1 2 3]". Shows at most ten numbers, so that a message with a million
/// numbers does not fill the logs.
std::string fewNumbers(const Eigen::VectorXd& numbers);

}  // namespace ddm
