// Parameters of the plants, the camera and the simulator: what values are valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_options.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

/// Collects the problems of one block, each as "block/key must <rule>, got <value>".
class Checker {
 public:
  explicit Checker(std::string block) : block_(std::move(block)) {}

  template <class Value>
  void require(bool ok, const char* key, const std::string& rule, const Value& value) {
    if (ok) return;
    std::ostringstream problem;
    problem << block_ << '/' << key << " must " << rule << ", got " << value;
    problems_.push_back(problem.str());
  }

  std::vector<std::string> problems() const { return problems_; }

 private:
  std::string block_;
  std::vector<std::string> problems_;
};

// Written so that NaN fails; an infinite length or mass has no physics either.
bool positive(double value) { return value > 0.0 && value <= std::numeric_limits<double>::max(); }
bool notNegative(double value) {
  return value >= 0.0 && value <= std::numeric_limits<double>::max();
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

}  // namespace

std::vector<std::string> plantTypes() { return {"pendulum", "moving_tile"}; }

std::vector<std::string> PlantBasics::problems() const {
  Checker plant("plant");
  plant.require(positive(max_torque), "max_torque", "be > 0 and finite", max_torque);
  // Stamps count whole nanoseconds, and one below a millisecond is none that a camera can keep.
  plant.require(dt >= 1e-3 && dt <= 10.0, "dt", "lie in [0.001, 10] s", dt);
  plant.require(notNegative(start_std), "start_std", "be >= 0 and finite", start_std);
  return plant.problems();
}

std::vector<std::string> PlantOptions::problems() const {
  const std::vector<std::string> types = plantTypes();
  const bool known = std::find(types.begin(), types.end(), type) != types.end();
  Checker plant("plant");
  plant.require(known, "type", "be one of: " + joined(types) + ", or PACKAGE/CLASS of a plugin",
                "\"" + type + "\"");
  plant.require(notNegative(gravity), "gravity", "be >= 0 and finite", gravity);
  plant.require(positive(length), "length", "be > 0 and finite", length);
  plant.require(positive(mass), "mass", "be > 0 and finite", mass);
  plant.require(notNegative(friction), "friction", "be >= 0 and finite", friction);
  plant.require(positive(tile_width), "tile_width", "be > 0 and finite", tile_width);
  plant.require(tile_softness >= 1.0 && positive(tile_softness), "tile_softness",
                "be >= 1 and finite", tile_softness);
  std::vector<std::string> problems = plant.problems();
  for (const std::string& problem : PlantBasics::problems()) problems.push_back(problem);
  return problems;
}

std::vector<std::string> CameraOptions::problems() const {
  Checker camera("camera");
  camera.require(size >= 4 && size <= 1024, "size", "lie in [4, 1024] pixels", size);
  camera.require(positive(half_extent), "half_extent", "be > 0 and finite", half_extent);
  camera.require(positive(rod_half_width), "rod_half_width", "be > 0 and finite", rod_half_width);
  camera.require(positive(edge_softness), "edge_softness", "be > 0 and finite", edge_softness);
  camera.require(noise_std >= 0.0 && noise_std <= 1.0, "noise_std", "lie in [0, 1]", noise_std);
  camera.require(brightness_drift >= 0.0 && brightness_drift < 1.0, "brightness_drift",
                 "lie in [0, 1)", brightness_drift);
  camera.require(positive(brightness_period), "brightness_period", "be > 0 and finite",
                 brightness_period);
  camera.require(clutter >= 0.0 && clutter <= 1.0, "clutter", "lie in [0, 1]", clutter);
  camera.require(clutter_seed >= 0, "clutter_seed", "be >= 0", clutter_seed);
  camera.require(delay >= 0 && delay <= 1000, "delay", "lie in [0, 1000] frames", delay);
  // A reader of bags takes the median interval for the time step: most frames must follow directly.
  camera.require(drop_rate >= 0.0 && drop_rate <= 0.3, "drop_rate", "lie in [0, 0.3]", drop_rate);
  return camera.problems();
}

std::vector<std::string> SimOptions::problems() const {
  Checker sim("sim");
  sim.require(watchdog >= 0.1 && watchdog <= 86400.0, "watchdog", "lie in [0.1, 86400] s",
              watchdog);
  return sim.problems();
}

std::vector<std::string> problemsOf(const PlantOptions& plant, const CameraOptions& camera) {
  std::vector<std::string> problems = plant.problems();
  for (const std::string& problem : camera.problems()) problems.push_back(problem);
  return problems;
}

void requireNone(const std::vector<std::string>& problems) {
  if (problems.empty()) return;
  std::string all;
  for (const std::string& problem : problems) all += "\n- " + problem;
  throw std::invalid_argument("invalid options:" + all);
}

}  // namespace ddm
