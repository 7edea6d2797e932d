// A plant for tests with replaceable functions, and a camera with all disturbances at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_plant_plugin/plant_plugin.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ddm_sim/camera.h"
#include "ddm_sim/plant.h"
#include "ddm_sim/rendered_image.h"

namespace ddm {
namespace testing {

/// An image with one grey value, fully covered by the plant.
inline RenderedImage plainImage(int size, std::uint8_t grey) {
  const auto num_pixels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  return brightOnBlack(size, std::vector<std::uint8_t>(num_pixels, grey));
}

/// A cart on a rail with one motor; the goal is the position 1 m.
inline PlantInfo toyInfo() {
  PlantInfo info;
  info.joints = {{"cart", JointKind::kLength}};
  info.state_names = {"position_m", "speed_m_per_s"};
  info.torque_names = {"force_n"};
  info.max_torque = Eigen::VectorXd::Constant(1, 6.0);
  info.start = Eigen::VectorXd::Zero(2);
  info.start_std = Eigen::VectorXd::Constant(2, 0.1);
  info.goal = Eigen::VectorXd::Unit(2, 0);
  info.error_unit = "m";
  info.tolerance = 0.05;
  return info;
}

/// By default this plant satisfies all rules of a plant, and its image is white in every state.
class ToyPlant : public Plant {
 public:
  struct Traits {
    PlantInfo info = toyInfo();
    std::function<Eigen::VectorXd(const Eigen::VectorXd&, const Eigen::VectorXd&)> advance =
        [](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
          return Eigen::VectorXd(state.array() + 0.1 * torque[0]);
        };
    std::function<double(const Eigen::VectorXd&, const Eigen::VectorXd&)> distance =
        [](const Eigen::VectorXd& state, const Eigen::VectorXd& goal) {
          return std::abs(state[0] - goal[0]);
        };
    std::function<RenderedImage(const Eigen::VectorXd&)> draw = [](const Eigen::VectorXd&) {
      return plainImage(51, 255);
    };

    // If empty, the default implementation of Plant is used.
    std::function<Eigen::VectorXd(std::mt19937_64*)> draw_goal;
    std::function<std::optional<double>(const Eigen::VectorXd&, const Eigen::VectorXd&)> reward;
  };

  explicit ToyPlant(const Traits& traits) : Plant(traits.info), traits_(traits) {}

  Eigen::VectorXd drawGoal(std::mt19937_64& engine) const override {
    return traits_.draw_goal ? traits_.draw_goal(&engine) : Plant::drawGoal(engine);
  }
  std::optional<double> reward(const Eigen::VectorXd& state,
                               const Eigen::VectorXd& torque) const override {
    return traits_.reward ? traits_.reward(state, torque) : Plant::reward(state, torque);
  }

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override {
    return traits_.advance(state, torque);
  }
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override {
    return traits_.distance(state, goal);
  }
  RenderedImage draw(const Eigen::VectorXd& state) const override { return traits_.draw(state); }
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override { return state.head(1); }

  Traits traits_;
};

/// Makes toy plants.
class ToyPlugin : public PlantPlugin {
 public:
  explicit ToyPlugin(ToyPlant::Traits traits) : traits_(std::move(traits)) {}

  std::string type() const override { return "their_package/Toy"; }
  void read(ParamReader* /*reader*/) override {}
  YAML::Node block() const override { return YAML::Load("{type: their_package/Toy}"); }
  std::unique_ptr<Plant> make() const override { return std::make_unique<ToyPlant>(traits_); }

 private:
  ToyPlant::Traits traits_;
};

/// A toy plant with the features that no plant of this package has: a wide colour image (of a
/// disc), a reward and drawn goals.
inline ToyPlant::Traits colourfulToy() {
  ToyPlant::Traits traits;
  traits.draw = [](const Eigen::VectorXd& state) {
    RenderedImage rendered{30, 10, 3, {}, {}};
    for (int i = 0; i < rendered.height; ++i) {
      for (int j = 0; j < rendered.width; ++j) {
        const bool inside = std::hypot(0.1 * (j - 15) - state[0], 0.1 * (i - 5)) < 0.3;
        const std::uint8_t red = inside ? 200 : 0;
        rendered.bytes.insert(rendered.bytes.end(), {red, static_cast<std::uint8_t>(red / 2), 0});
        rendered.cover.push_back(inside ? 255 : 0);
      }
    }
    return rendered;
  };
  traits.reward = [](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
    return -state.squaredNorm() - 0.1 * torque.squaredNorm();
  };
  traits.draw_goal = [](std::mt19937_64* engine) {
    const double position = std::uniform_real_distribution<double>(0.5, 1.5)(*engine);
    return Eigen::VectorXd(position * Eigen::VectorXd::Unit(2, 0));
  };
  return traits;
}

inline CameraOptions allNuisances() {
  CameraOptions options;
  options.noise_std = 0.05;
  options.brightness_drift = 0.2;
  options.clutter = 0.6;
  options.delay = 1;
  options.drop_rate = 0.3;
  return options;
}

}  // namespace testing
}  // namespace ddm
