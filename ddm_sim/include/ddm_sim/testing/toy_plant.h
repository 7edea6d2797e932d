// A plant whose every answer a test may change.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_factory.h"
#include "ddm_sim/plant_options.h"

namespace ddm {
namespace testing {

/// By default it keeps all rules of a plant; its picture is white, whatever its state.
class ToyPlant : public Plant {
 public:
  using Bytes = std::vector<std::uint8_t>;

  struct Traits {
    Eigen::VectorXd start = Eigen::Vector2d::Zero();
    int torque_dim = 1;
    double dt = PlantBasics().dt;                  // [s]
    double max_torque = PlantBasics().max_torque;  // [N m]
    double start_std = 0.1;
    int image_size = CameraOptions().size;  // [pixels]
    bool turns = true;
    std::vector<std::string> joints = {"arm"};
    std::vector<std::string> states = {"angle_rad", "rate_rad_per_s"};
    std::vector<std::string> torques = {"torque_nm"};
    Eigen::VectorXd goal = Eigen::Vector2d(1.0, 0.0);
    double goal_error = 0.5;
    Eigen::VectorXd place = Eigen::Vector2d::Zero();
    std::function<Eigen::VectorXd(const Eigen::VectorXd&, const Eigen::VectorXd&)> advance =
        [](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
          return Eigen::VectorXd(state.array() + 0.1 * torque[0]);
        };
    std::function<Bytes(const Eigen::VectorXd&)> draw = [](const Eigen::VectorXd&) {
      return Bytes(51 * 51, 255);
    };
    std::function<Bytes(const Eigen::VectorXd&)> cover = [](const Eigen::VectorXd&) {
      return Bytes(51 * 51, 255);
    };
  };

  explicit ToyPlant(const Traits& traits)
      : Plant(traits.start, traits.torque_dim, traits.dt, traits.max_torque, traits.start_std),
        traits_(traits) {}

  Eigen::VectorXd goalState() const override { return traits_.goal; }
  bool turns() const override { return traits_.turns; }
  int imageSize() const override { return traits_.image_size; }
  std::vector<std::string> jointNames() const override { return traits_.joints; }
  std::vector<std::string> stateNames() const override { return traits_.states; }
  std::vector<std::string> torqueNames() const override { return traits_.torques; }

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override {
    return traits_.advance(state, torque);
  }
  double distanceToGoal(const Eigen::VectorXd& /*state*/) const override {
    return traits_.goal_error;
  }
  Bytes draw(const Eigen::VectorXd& state) const override { return traits_.draw(state); }
  Bytes cover(const Eigen::VectorXd& state) const override { return traits_.cover(state); }
  Eigen::VectorXd locate(const Eigen::VectorXd& /*state*/) const override { return traits_.place; }

  Traits traits_;
};

/// Options of the plugin "their_package/Toy" that makes toys.
inline PlantOptions toyOptions(std::function<std::unique_ptr<Plant>()> make) {
  struct Maker : PlantMaker {
    std::unique_ptr<Plant> make(const CameraOptions& /*camera*/) const override {
      return make_toy();
    }
    std::function<std::unique_ptr<Plant>()> make_toy;
  };
  const auto maker = std::make_shared<Maker>();
  maker->make_toy = std::move(make);
  PlantOptions options;
  options.type = "their_package/Toy";
  options.maker = maker;
  return options;
}

inline PlantOptions toyOptions(const ToyPlant::Traits& traits) {
  return toyOptions([traits] { return std::make_unique<ToyPlant>(traits); });
}

}  // namespace testing
}  // namespace ddm
