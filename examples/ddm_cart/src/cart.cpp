// Example of a plant in a package of its own: a cart on a rail, pushed by a motor.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_plant_plugin/plant_plugin.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <utility>

namespace ddm_cart {

constexpr double kHalfWidth = 0.3;     // half the width and height of the cart in the image [m]
constexpr double kHalfExtent = 1.2;    // distance from the middle of the image to its edge [m]
constexpr double kEdgeSoftness = 0.2;  // width over which grey falls from 1 to 0 [m]

/// Block `plant`: the keys of every plant (max_torque is a force here [N]), then those of the cart.
struct CartOptions : ddm::PlantOptions {
  double mass = 1.0;      ///< m [kg]
  double friction = 2.0;  ///< b, viscous friction [N s/m]
  double track = 1.0;     ///< distance from the middle of the rail to each buffer [m]
  double goal = 0.6;      ///< goal position of the cart [m]

  CartOptions() { max_torque = {2.0}; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    PlantOptions::visit(visitor);
    visitor("mass", mass);
    visitor("friction", friction);
    visitor("track", track);
    visitor("goal", goal);
  }

  std::vector<std::string> problems() const {
    ddm::OptionChecks plant("plant");
    plant.requirePositive("mass", mass);
    plant.requirePositive("friction", friction);
    plant.requirePositive("track", track);
    plant.require(track <= kHalfExtent, "track", "be at most 1.2, the edge of the image", track);
    plant.require(std::abs(goal) <= track, "goal", "lie within +- plant/track", goal);
    plant.add(PlantOptions::problems());
    return plant.problems();
  }
};

ddm::PlantInfo infoOf(const CartOptions& options) {
  ddm::PlantInfo info;
  info.joints = {{"cart", ddm::JointKind::kLength}};
  info.state_names = {"x_m", "rate_m_per_s"};
  info.torque_names = {"force_n"};
  info.max_torque = ddm::forEach(options.max_torque, 1, "plant/max_torque");
  info.dt = options.dt;
  info.start = Eigen::VectorXd::Zero(2);
  info.start_std = ddm::forEach(options.start_std, 2, "plant/start_std");
  info.goal = (Eigen::VectorXd(2) << options.goal, 0.0).finished();
  info.error_unit = "m";
  info.tolerance = 0.05;
  return info;
}

/// The state is (x, v), position [m] and rate [m/s]; u is a force [N]. Between the buffers
///
///   m v' = u - b v,   x' = v
///
/// is solved exactly over dt. The cart stops at a buffer.
class Cart : public ddm::Plant {
 public:
  explicit Cart(const CartOptions& options)
      : Plant(infoOf(ddm::checked(options))), options_(options) {}

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& force) const override {
    const double final_rate = force[0] / options_.friction;
    const double time_constant = options_.mass / options_.friction;
    const double decay = std::exp(-options_.dt / time_constant);
    const double excess = state[1] - final_rate;
    const double x = state[0] + final_rate * options_.dt + excess * time_constant * (1.0 - decay);
    if (std::abs(x) >= options_.track)
      return Eigen::Vector2d(std::copysign(options_.track, x), 0.0);
    return Eigen::Vector2d(x, final_rate + excess * decay);
  }

  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override {
    return std::abs(state[0] - goal[0]);
  }

  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override {
    return Eigen::VectorXd::Constant(1, state[0]);
  }

  /// Draws a white cart on black. Its brightness falls from 1 to 0 over kEdgeSoftness at the edges.
  ddm::RenderedImage draw(const Eigen::VectorXd& state) const override {
    const int size = options_.image_size;
    const double pixel = 2.0 * kHalfExtent / size;  // [m]
    const auto inside = [](double offset) {         // 1 inside the cart, 0 outside
      const double depth = kHalfWidth - std::abs(offset);
      return std::min(std::max(depth / kEdgeSoftness + 0.5, 0.0), 1.0);
    };
    std::vector<std::uint8_t> grey;
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const double x = (column + 0.5) * pixel - kHalfExtent;
        const double y = (row + 0.5) * pixel - kHalfExtent;
        const double level = inside(x - state[0]) * inside(y);
        grey.push_back(static_cast<std::uint8_t>(std::lround(255.0 * level)));
      }
    }
    return ddm::brightOnBlack(size, std::move(grey));
  }

  CartOptions options_;
};

using CartPlugin = ddm::PlantPluginOf<Cart, CartOptions>;

}  // namespace ddm_cart

PLUGINLIB_EXPORT_CLASS(ddm_cart::CartPlugin, ddm::PlantPlugin)
