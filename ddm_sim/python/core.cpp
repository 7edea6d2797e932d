// The Python module ddm_sim._core: class Environment, a plant in front of its camera.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/python_values.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/camera.h>
#include <ddm_sim/environment.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ddm {
namespace {

/// Plant and camera of an environment.
struct Setting {
  std::shared_ptr<const PlantPlugin> plant;
  CameraOptions camera;
};

Setting read(const YAML::Node& blocks) {
  ParamReader reader(blocks);
  const Setting setting{readPlant(&reader), reader.read<CameraOptions>("camera")};
  reader.requireValid();
  return setting;
}

/// Sets the blocks `plant` and `camera` to the effective values of all keys.
void complete(const Setting& setting, YAML::Node* blocks) {
  (*blocks)["plant"] = setting.plant->block();
  (*blocks)["camera"] = toYaml(setting.camera);
}

py::array_t<std::uint8_t> arrayOf(const RenderedImage& rendered) {
  std::vector<Eigen::Index> shape = {rendered.height, rendered.width};
  if (rendered.channels > 1) shape.push_back(rendered.channels);
  return copyOf(rendered.bytes.data(), shape);
}

class PythonEnvironment {
 public:
  PythonEnvironment(const std::string& plant, const py::dict& options) {
    const std::string file = plantFile(plant);
    YAML::Node own(YAML::NodeType::Map);
    complete(read(readBlocks(file)), &own);  // the keys depend on the type of the plant
    blocks_ = mergedBlocks(py::make_tuple(file), options, own);
    const Setting setting = read(blocks_);
    complete(setting, &blocks_);
    if (hasKey(blocks_, "trial", "num_steps") &&
        (!parseValue(blocks_["trial"]["num_steps"], &trial_steps_) || trial_steps_ < 1)) {
      throw py::value_error("trial/num_steps must be an integer >= 1, got " +
                            YAML::Dump(blocks_["trial"]["num_steps"]));
    }
    environment_ = std::make_unique<Environment>(makePlant(*setting.plant), setting.camera);
    blocks_["controller"]["torque_dim"] = valueToYaml(plantInfo().torqueDim());
    blocks_["controller"]["dt"] = valueToYaml(plantInfo().dt);
    reset(py::int_(0), py::int_(0), false, py::none());
  }

  py::tuple reset(const py::object& seed, const py::object& trial, bool evaluation,
                  const py::object& start) {
    std::optional<Eigen::VectorXd> state;
    if (!start.is_none()) state = vectorOf(start, "start", environment_->plant().stateDim());
    const TrialId id{wholeOf<std::uint64_t>(seed, "seed"), wholeOf<std::uint32_t>(trial, "trial"),
                     evaluation};
    const RenderedImage image = environment_->reset(id, state);
    evaluation_ = evaluation;
    goal_ = arrayOf(environment_->goalImage());
    goal_.attr("setflags")(false);  // all dictionaries `info` share it
    const Plant& plant = environment_->plant();
    return py::make_tuple(arrayOf(image), info(plant.goalError(plant.state())));
  }

  py::tuple step(const py::object& torque) {
    const Plant& plant = environment_->plant();
    const Eigen::VectorXd u = vectorOf(torque, "torque", plant.torqueDim());
    const Eigen::VectorXd before = plant.state();
    const std::uint64_t begin = environment_->numSteps();
    const RenderedImage image = environment_->stepUntilSeen(u);
    const auto num_steps = static_cast<int>(environment_->numSteps() - begin);
    const double error = plant.goalError(plant.state());
    const double at_goal = error <= plantInfo().tolerance ? 1.0 : 0.0;
    const double reward = plant.stepReward(before, u, num_steps).value_or(at_goal);
    const bool truncated = environment_->numSteps() >= static_cast<std::uint64_t>(maxSteps());
    return py::make_tuple(arrayOf(image), reward, false, truncated, info(error));
  }

  py::array_t<std::uint8_t> render() const {
    const Plant& plant = environment_->plant();
    return arrayOf(plant.viewModel() ? plant.view(plant.state()) : plant.render(plant.state()));
  }

  /// Number of images of this episode, as in run_experiment.
  int maxSteps() const {
    const int of_plant = plantInfo().evaluation_steps;
    return evaluation_ && of_plant > 0 ? of_plant : trial_steps_;
  }

  const PlantInfo& plantInfo() const { return environment_->plant().info(); }
  py::object configuration() const { return dictOf(blocks_); }
  py::tuple imageShape() const { return goal_.attr("shape"); }

 private:
  py::dict info(double error) const {
    py::dict out;
    out[state_key_] = ddm::arrayOf(environment_->plant().state());
    out[error_key_] = error;
    out[at_goal_key_] = error <= plantInfo().tolerance;
    out[time_key_] = environment_->time();
    out[goal_key_] = goal_;
    return out;
  }

  YAML::Node blocks_;  // of the plant's file and of the options, completed
  std::unique_ptr<Environment> environment_;
  int trial_steps_ = 100;  // trial/num_steps, and its default
  bool evaluation_ = false;
  py::object goal_;
  // The keys of `info` are made once, because step() is called often.
  const py::str state_key_{"state"}, error_key_{"error"}, at_goal_key_{"at_goal"};
  const py::str time_key_{"time"}, goal_key_{"goal_image"};
};

}  // namespace

PYBIND11_MODULE(_core, module) {
  using py::arg;
  module.def("plants", [] { return plantsOf("ddm_sim"); });
  py::class_<PythonEnvironment>(module, "Environment")
      .def(py::init<const std::string&, const py::dict&>(), arg("plant"), arg("options"))
      .def("reset", &PythonEnvironment::reset, arg("seed"), arg("trial"), arg("evaluation"),
           arg("start").none(true))
      .def("step", &PythonEnvironment::step, arg("torque"))
      .def("render", &PythonEnvironment::render)
      .def_property_readonly("max_steps", &PythonEnvironment::maxSteps)
      .def_property_readonly("image_shape", &PythonEnvironment::imageShape)
      .def_property_readonly(
          "max_torque",
          [](const PythonEnvironment& self) { return arrayOf(self.plantInfo().max_torque); })
      .def_property_readonly("dt",
                             [](const PythonEnvironment& self) { return self.plantInfo().dt; })
      .def_property_readonly("configuration", &PythonEnvironment::configuration);
}

}  // namespace ddm
