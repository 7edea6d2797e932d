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
#include <utility>

namespace ddm {
namespace {

/// What an environment is made from.
struct Setting {
  std::shared_ptr<const PlantPlugin> plant;
  CameraOptions camera;
  YAML::Node blocks;  ///< all blocks of the plant's file, completed
};

Setting read(const YAML::Node& blocks) {
  ParamReader reader(blocks);
  Setting setting;
  setting.plant = readPlant(&reader);
  setting.camera = reader.read<CameraOptions>("camera");
  reader.requireValid();
  setting.blocks = YAML::Clone(blocks);
  setting.blocks["plant"] = setting.plant->block();
  setting.blocks["camera"] = toYaml(setting.camera);
  return setting;
}

/// Reads the file of the plant, then the options of the caller, which need the keys of the plant.
Setting settingOf(const std::string& plant, const py::dict& options) {
  const YAML::Node file = readBlocks(plantFile(plant));
  const YAML::Node all = read(file).blocks;
  YAML::Node own(YAML::NodeType::Map);
  own["plant"] = all["plant"];
  own["camera"] = all["camera"];
  YAML::Node blocks = YAML::Clone(file);
  overlay(mergedBlocks(py::tuple(), options, own), &blocks);
  return read(blocks);
}

py::array_t<std::uint8_t> arrayOf(const Picture& picture) {
  const Eigen::Index height = picture.height;
  const Eigen::Index width = picture.width;
  if (picture.channels == 1)
    return py::array_t<std::uint8_t>({height, width}, picture.bytes.data());
  const Eigen::Index channels = picture.channels;
  return py::array_t<std::uint8_t>({height, width, channels}, picture.bytes.data());
}

class PythonEnvironment {
 public:
  PythonEnvironment(const std::string& plant, const py::dict& options)
      : setting_(settingOf(plant, options)),
        environment_(makePlant(*setting_.plant), setting_.camera) {
    const PlantInfo& info = environment_.plant().info();
    const YAML::Node& blocks = setting_.blocks;
    if (hasKey(blocks, "trial", "num_steps") &&
        (!parseValue(blocks["trial"]["num_steps"], &trial_steps_) || trial_steps_ < 1)) {
      throw py::value_error("trial/num_steps must be an integer >= 1, got " +
                            YAML::Dump(blocks["trial"]["num_steps"]));
    }
    setting_.blocks["controller"]["torque_dim"] = valueToYaml(info.torqueDim());
    setting_.blocks["controller"]["dt"] = valueToYaml(info.dt);
    reset(py::int_(0), py::int_(0), false, py::none());
  }

  py::tuple reset(const py::object& seed, const py::object& trial, bool evaluation,
                  const py::object& start) {
    std::optional<Eigen::VectorXd> state;
    if (!start.is_none()) state = vectorOf(start, "start", environment_.plant().stateDim());
    const Picture image =
        environment_.reset(wholeOf<std::uint64_t>(seed, "seed"),
                           wholeOf<std::uint32_t>(trial, "trial"), evaluation, state);
    evaluation_ = evaluation;
    goal_ = arrayOf(environment_.goalImage());
    goal_.attr("setflags")(false);  // all dictionaries `info` share it
    return py::make_tuple(arrayOf(image), info());
  }

  py::tuple step(const py::object& torque) {
    const Plant& plant = environment_.plant();
    const Eigen::VectorXd u = vectorOf(torque, "torque", plant.torqueDim());
    const Eigen::VectorXd before = plant.state();
    const std::uint64_t begin = environment_.numSteps();
    const Picture image = environment_.stepUntilSeen(u);
    const auto num_steps = static_cast<int>(environment_.numSteps() - begin);
    const py::dict info = this->info();
    const std::optional<double> reward = plant.stepReward(before, u, num_steps);
    const bool at_goal = PyObject_IsTrue(py::object(info["at_goal"]).ptr()) == 1;
    const auto limit = static_cast<std::uint64_t>(maxSteps());
    return py::make_tuple(arrayOf(image), reward ? *reward : (at_goal ? 1.0 : 0.0), false,
                          environment_.numSteps() >= limit, info);
  }

  py::array_t<std::uint8_t> render() const {
    const Plant& plant = environment_.plant();
    return arrayOf(plant.viewModel() ? plant.view(plant.state()) : plant.render(plant.state()));
  }

  /// Number of images of this episode, as in run_experiment.
  int maxSteps() const {
    const int of_plant = plantInfo().evaluation_steps;
    return evaluation_ && of_plant > 0 ? of_plant : trial_steps_;
  }

  const PlantInfo& plantInfo() const { return environment_.plant().info(); }
  py::object configuration() const { return dictOf(setting_.blocks); }
  py::tuple imageShape() const { return goal_.attr("shape"); }

 private:
  py::dict info() const {
    const Plant& plant = environment_.plant();
    const double error = plant.goalError(plant.state());
    py::dict out;
    out["state"] = ddm::arrayOf(plant.state());
    out["error"] = error;
    out["at_goal"] = error <= plant.info().tolerance;
    out["time"] = environment_.time();
    out["applied_torque"] = ddm::arrayOf(environment_.applied());
    out["goal_image"] = goal_;
    return out;
  }

  Setting setting_;
  Environment environment_;
  int trial_steps_ = 100;  // trial/num_steps, and its default
  bool evaluation_ = false;
  py::object goal_;
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
