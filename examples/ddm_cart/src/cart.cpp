// A cart on a rail, pushed by a motor: a plant as any package can bring its own.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_plant_plugin/plant_plugin.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>

namespace ddm_cart {

/// The block `plant`: the keys of every plant (max_torque is a force here [N]), then our own.
struct CartOptions : ddm::PlantBasics {
  double mass = 1.0;        ///< m [kg]
  double friction = 2.0;    ///< b, viscous [N s/m]
  double track = 1.0;       ///< from the middle of the rail to each buffer [m]
  double goal = 0.6;        ///< where the cart shall stop [m]
  double half_width = 0.3;  ///< of the cart in the picture, and half its height [m]

  CartOptions() { max_torque = 2.0; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    PlantBasics::visit(visitor);
    visitor("mass", mass);
    visitor("friction", friction);
    visitor("track", track);
    visitor("goal", goal);
    visitor("half_width", half_width);
  }

  std::vector<std::string> problems() const {
    std::vector<std::string> out = PlantBasics::problems();
    const auto require = [&out](bool ok, const std::string& rule, double value) {
      if (!ok) out.push_back("plant/" + rule + ", got " + std::to_string(value));
    };
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    require(positive(mass), "mass must be > 0 and finite", mass);
    require(positive(friction), "friction must be > 0 and finite", friction);
    require(positive(track), "track must be > 0 and finite", track);
    require(std::abs(goal) <= track, "goal must lie within +- plant/track", goal);
    require(positive(half_width), "half_width must be > 0 and finite", half_width);
    return out;
  }
};

/// State (x, v): position [m] and rate [m/s]; one force [N]. Between the buffers
///
///   m v' = u - b v,   x' = v,   solved exactly over dt; at a buffer it stops
class Cart : public ddm::Plant {
 public:
  Cart(const CartOptions& options, const ddm::CameraOptions& camera)
      : Plant(Eigen::Vector2d::Zero(), /*torque_dim=*/1, options.dt, options.max_torque,
              options.start_std),
        options_(options),
        camera_(camera) {
    if (options.track > camera.half_extent) {  // neither block can see this by itself
      throw std::invalid_argument("plant/track must be at most camera/half_extent: got " +
                                  std::to_string(options.track) + " and " +
                                  std::to_string(camera.half_extent));
    }
  }

  Eigen::VectorXd goalState() const override { return Eigen::Vector2d(options_.goal, 0.0); }
  bool turns() const override { return false; }
  int imageSize() const override { return camera_.size; }
  std::vector<std::string> jointNames() const override { return {"cart"}; }
  std::vector<std::string> stateNames() const override { return {"x_m", "rate_m_per_s"}; }
  std::vector<std::string> torqueNames() const override { return {"force_n"}; }

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& force) const override {
    const double final_rate = force[0] / options_.friction;
    const double time_constant = options_.mass / options_.friction;
    const double decay = std::exp(-dt() / time_constant);
    const double excess = state[1] - final_rate;
    const double x = state[0] + final_rate * dt() + excess * time_constant * (1.0 - decay);
    if (std::abs(x) >= options_.track)
      return Eigen::Vector2d(std::copysign(options_.track, x), 0.0);
    return Eigen::Vector2d(x, final_rate + excess * decay);
  }

  double distanceToGoal(const Eigen::VectorXd& state) const override {
    return std::abs(state[0] - options_.goal);
  }

  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override {
    return Eigen::Vector2d(state[0], 0.0);
  }

  /// White on black; grey falls from 1 to 0 over camera/edge_softness, as at the pendulum's rod.
  std::vector<std::uint8_t> draw(const Eigen::VectorXd& state) const override {
    const double pixel = 2.0 * camera_.half_extent / camera_.size;  // [m]
    const auto inside = [this](double offset) {  // 1 in the middle, 0 beyond the edge
      const double depth = options_.half_width - std::abs(offset);
      return std::min(std::max(depth / camera_.edge_softness + 0.5, 0.0), 1.0);
    };
    std::vector<std::uint8_t> grey;
    for (int row = 0; row < camera_.size; ++row) {
      for (int column = 0; column < camera_.size; ++column) {
        const double x = (column + 0.5) * pixel - camera_.half_extent;
        const double y = (row + 0.5) * pixel - camera_.half_extent;
        const double level = inside(x - state[0]) * inside(y);
        grey.push_back(static_cast<std::uint8_t>(std::lround(255.0 * level)));
      }
    }
    return grey;
  }

  /// White on black: as bright as it is, it hides a camera's clutter.
  std::vector<std::uint8_t> cover(const Eigen::VectorXd& state) const override {
    return draw(state);
  }

  CartOptions options_;
  ddm::CameraOptions camera_;
};

using CartPlugin = ddm::PlantPluginOf<Cart, CartOptions>;

}  // namespace ddm_cart

PLUGINLIB_EXPORT_CLASS(ddm_cart::CartPlugin, ddm::PlantPlugin)
