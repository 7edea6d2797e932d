// Implements MujocoPlant: a plant that a model file describes and that MuJoCo simulates.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_plant.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "ddm_sim/plant.h"
#include "motors.h"
#include "mujoco_physics.h"

namespace ddm {
namespace {

bool isHinge(const MujocoModel& model, int joint) {
  return model.get().jnt_type[joint] == mjJNT_HINGE;
}

/// Makes a state from a list of numbers. If the list has no rates, the rates are 0.
/// @param numbers  one number per joint, or per joint and rate; empty: all 0
/// @throws std::invalid_argument for any other number of elements
Eigen::VectorXd stateOf(const std::vector<double>& numbers, int num_joints, const char* key) {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(2 * num_joints);
  const auto count = static_cast<Eigen::Index>(numbers.size());
  if (count != 0 && count != num_joints && count != 2 * num_joints) {
    refuseModel("plant/", key, " must have a number for each of the ", num_joints,
                " joints, or one for each and then one for each rate, got ", count);
  }
  std::copy(numbers.begin(), numbers.end(), state.data());
  return state;
}

/// Number of physics steps in one time step.
/// @throws std::invalid_argument if plant/dt is not a multiple of the physics time step
int framesOf(const MujocoModel& model, const MujocoOptions& options) {
  constexpr double kMaxFrames = 1e6;  // a time step then takes about a second to compute
  const double dt = options.dt;
  const double step = timestepOf(model, options);
  const double frames = std::max(1.0, std::round(dt / step));
  if (!(frames <= kMaxFrames)) {
    refuseModel("plant/timestep must divide plant/dt into at most 1000000 frames, got ", step,
                " s, which is ", frames, " frames in plant/dt: use a larger plant/timestep");
  }
  if (std::abs(frames * step - dt) <= 1e-9 * dt) return static_cast<int>(frames);
  refuseModel("plant/dt must be a whole multiple of the timestep of ",
              options.timestep > 0.0 ? "plant/timestep" : model.uri(), ", ", step, " s, got ", dt,
              ": the nearest is ", frames * step);
}

/// Name of a joint, for the columns of CSV files.
/// @throws std::invalid_argument if the name cannot head a column
std::string columnOf(const MujocoModel& model, int joint) {
  const std::string name = model.name(mjOBJ_JOINT, joint);
  if (usableName(name)) return name;
  refuseModel(
      "the joint \"", name, "\" of ", model.uri(),
      " must have a name of ASCII characters without blanks, commas and double quotes, because it "
      "heads columns of CSV files: rename it in the file");
}

std::vector<std::string> stateNames(const MujocoModel& model, const MujocoOptions& options) {
  if (!options.state_names.empty()) return options.state_names;
  std::vector<std::string> names;
  for (const char* rate : {"", "_per_s"}) {
    for (int i = 0; i < model.get().njnt; ++i) {
      names.push_back(columnOf(model, i) + (isHinge(model, i) ? "_rad" : "_m") + rate);
    }
  }
  return names;
}

std::vector<std::string> torqueNames(const MujocoModel& model, const MujocoOptions& options) {
  if (!options.torque_names.empty()) return options.torque_names;
  std::vector<std::string> names;
  for (const Motor& motor : motorsOf(model, options)) {
    names.push_back(columnOf(model, motor.joint) + (isHinge(model, motor.joint) ? "_nm" : "_n"));
  }
  return names;
}

/// Joints whose error is measured: all hinges, or all slides if there are no hinges, because angles
/// and lengths cannot be compared. Empty if the options measure the error of sites.
std::vector<int> errorJoints(const MujocoModel& model, const MujocoOptions& options) {
  std::vector<int> hinges, slides;
  for (int i = 0; options.error_sites.empty() && i < model.get().njnt; ++i) {
    (isHinge(model, i) ? hinges : slides).push_back(i);
  }
  return hinges.empty() ? slides : hinges;
}

int evaluationSteps(const MujocoOptions& options, int frames) {
  if (options.episode_frames % frames != 0) {
    refuseModel("plant/episode_frames must be whole time steps of plant/dt, which is ", frames,
                " frames, got ", options.episode_frames);
  }
  return options.episode_frames / frames;
}

/// @pre options.problems() is empty
PlantInfo infoOf(const MujocoModel& model, const MujocoOptions& options) {
  const mjModel& m = model.get();
  const int n = m.njnt;
  PlantInfo info;
  for (int i = 0; i < n; ++i) {
    info.joints.push_back(
        {columnOf(model, i), isHinge(model, i) ? JointKind::kAngle : JointKind::kLength});
  }
  info.state_names = stateNames(model, options);
  if (info.stateDim() != 2 * n) {
    refuseModel(
        "plant/state_names must have a name for each joint and then one for each rate, got ",
        info.stateDim());
  }
  info.torque_names = torqueNames(model, options);
  const std::vector<double> limits = limitsOf(model, options);
  if (info.torque_names.size() != limits.size()) {
    refuseModel("plant/torque_names must have a name for each motor, got ", info.torqueDim());
  }
  info.max_torque = Eigen::Map<const Eigen::VectorXd>(limits.data(), info.torqueDim());
  info.dt = options.dt;
  info.start = stateOf(options.start, n, "start");
  if (options.start.empty()) std::copy_n(m.qpos0, n, info.start.data());
  const Eigen::ArrayXd normal = forEach(options.start_std, 2 * n, "plant/start_std");
  const Eigen::ArrayXd uniform = stateOf(options.start_uniform, n, "start_uniform");
  info.start_std = (uniform == 0.0).select(normal, (normal.square() + uniform.square() / 3).sqrt());
  info.goal = stateOf(options.goal, n, "goal");
  const std::vector<int> joints = errorJoints(model, options);
  info.error_unit = !joints.empty() && isHinge(model, joints[0]) ? "deg" : "m";
  info.tolerance = options.tolerance;
  info.evaluation_steps = evaluationSteps(options, framesOf(model, options));
  return info;
}

/// Places with these names in the model. Skips empty names.
std::vector<Place> places(const MujocoModel& model, const std::vector<std::string>& names,
                          const std::string& key) {
  std::vector<Place> out;
  for (const std::string& name : names) {
    if (!name.empty()) out.push_back(model.place(name, key));
  }
  return out;
}

RenderOptions imageLook(const MujocoOptions& options) {
  RenderOptions look = options.look;
  look.width = look.height = options.image_size;
  return look;
}

/// Options of the large image for people: the same scene and camera as the learner's image.
RenderOptions viewLook(const MujocoOptions& options) {
  RenderOptions look = options.look;
  look.width = 640;
  look.height = 480;
  look.colour = look.for_people = true;
  look.supersampling = 1;
  return look;
}

const Reward* rewardOf(const MujocoOptions& options, const PlantInfo& info) {
  for (const Reward& reward : rewards()) {
    if (reward.name != options.reward) continue;
    const int joints = static_cast<int>(info.joints.size());
    if (reward.num_joints == joints && reward.num_motors == info.torqueDim()) return &reward;
    refuseModel("plant/reward must be one for ", joints, " joints and ", info.torqueDim(),
                " motors, got ", reward.name, ", which is for ", reward.num_joints, " and ",
                reward.num_motors);
  }
  return nullptr;
}

}  // namespace

MujocoPlant::MujocoPlant(std::shared_ptr<const MujocoModel> model, const MujocoOptions& options)
    : Plant((checked(options), requirePositionsAndRates(*model), infoOf(*model, options))),
      model_(std::move(model)),
      physics_(std::make_unique<MujocoPhysics>(model_, options)),
      num_frames_(framesOf(*model_, options)),
      start_normal_(forEach(options.start_std, stateDim(), "plant/start_std")),
      start_uniform_(stateOf(options.start_uniform, physics_->numJoints(), "start_uniform")),
      error_joints_(errorJoints(*model_, options)),
      error_sites_(places(*model_, options.error_sites, "plant/error_sites")),
      visible_sites_(places(*model_, options.visible_sites, "plant/visible_sites")),
      goal_site_(places(*model_, {options.goal_site}, "plant/goal_site")),
      goal_distance_(options.goal_distance),
      image_(std::make_unique<Renderer>(model_, imageLook(options))),
      view_(std::make_unique<Renderer>(model_, viewLook(options))),
      reward_(rewardOf(options, info())),
      reward_scale_(info().max_torque) {
  const std::vector<Motor> motors = motorsOf(*model_, options);
  for (std::size_t i = 0; i < motors.size(); ++i) {
    if (motors[i].limit > 0.0) reward_scale_[static_cast<Eigen::Index>(i)] = motors[i].limit;
  }
}

MujocoPlant::~MujocoPlant() = default;

Eigen::VectorXd MujocoPlant::drawStart(std::mt19937_64& engine) const {
  std::normal_distribution<double> normal;
  Eigen::VectorXd start = info().start;
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    std::uniform_real_distribution<double> uniform(-start_uniform_[i], start_uniform_[i]);
    start[i] += start_normal_[i] * normal(engine);
    start[i] += uniform(engine);
  }
  return start;
}

Eigen::VectorXd MujocoPlant::drawGoal(std::mt19937_64& engine) const {
  if (goal_site_.empty()) return info().goal;
  const double angle = std::uniform_real_distribution<double>(0.0, 2.0 * kPi)(engine);
  const double distance =
      std::uniform_real_distribution<double>(goal_distance_[0], goal_distance_[1])(engine);
  return goalAt(distance * Eigen::Vector2d(std::sin(angle), std::cos(angle)));
}

Eigen::VectorXd MujocoPlant::goalAt(const Eigen::VectorXd& target) const {
  if (goal_site_.empty()) return Plant::goalAt(target);
  if (target.size() != 2 || !target.allFinite()) {
    refuseModel("plant: the target must be two finite numbers, x and y [m], got ",
                fewNumbers(target));
  }
  return physics_->reach(goal_site_[0], target, info().goal);
}

std::optional<double> MujocoPlant::reward(const Eigen::VectorXd& state,
                                          const Eigen::VectorXd& torque) const {
  if (reward_ == nullptr) return std::nullopt;
  return reward_->value({state, torque.cwiseQuotient(reward_scale_), goal()});
}

Eigen::VectorXd MujocoPlant::advance(const Eigen::VectorXd& state,
                                     const Eigen::VectorXd& torque) const {
  return physics_->frames(state, torque, num_frames_).rightCols(1);
}

double MujocoPlant::rewardOfStep(const Eigen::VectorXd& state,
                                 const Eigen::VectorXd& torque) const {
  const Eigen::MatrixXd states = physics_->frames(state, torque, num_frames_);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < states.cols(); ++i) sum += *reward(states.col(i), torque);
  return sum;
}

double MujocoPlant::distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const {
  double error = 0.0;
  for (const int i : error_joints_) {
    error = std::max(error, isHinge(*model_, i) ? degreesBetween(state[i], goal[i])
                                                : std::abs(state[i] - goal[i]));
  }
  if (error_sites_.empty()) return error;
  const Eigen::VectorXd apart =
      physics_->places(error_sites_, state) - physics_->places(error_sites_, goal);
  for (Eigen::Index i = 0; i < apart.size(); i += 3) {
    error = std::max(error, apart.segment<3>(i).norm());
  }
  return error;
}

RenderedImage MujocoPlant::draw(const Eigen::VectorXd& state) const {
  return image_->draw(physics_->placed(state));
}

std::optional<CameraModel> MujocoPlant::cameraModel() const {
  return image_->camera(physics_->placed(state()));
}

std::optional<CameraModel> MujocoPlant::viewModel() const {
  return view_->camera(physics_->placed(state()));
}

RenderedImage MujocoPlant::view(const Eigen::VectorXd& state) const {
  if (goal_site_.empty()) return view_->draw(physics_->placed(state));
  const Eigen::Vector2d target = physics_->places(goal_site_, goal()).head(2);
  return view_->draw(physics_->placed(state, target));
}

Eigen::VectorXd MujocoPlant::locate(const Eigen::VectorXd& state) const {
  return visible_sites_.empty() ? physics_->bodies(state) : physics_->places(visible_sites_, state);
}

MujocoOptions completed(MujocoOptions options, const MujocoModel& model) {
  requirePositionsAndRates(model);
  const std::string& digest = model.digest();
  if (!options.model_digest.empty() && options.model_digest != digest) {
    refuseModel(
        "plant/model_digest must be that of ", model.uri(), " and the files that it names, ",
        digest, ", got ", options.model_digest,
        ": one of them has changed since this configuration was saved; put it back, or begin anew "
        "without this key");
  }
  options.model_digest = digest;
  options.max_torque = limitsOf(model, options);
  return options;
}

}  // namespace ddm
