// The Python module ddm_mpc._core: class Controller.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_reader.h>
#include <ddm_common/python_values.h>
#include <ddm_mpc/controller.h>
#include <ddm_mpc/mpc_options.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace ddm {
namespace {

/// Algorithm 1 for one image after the other, in the same way as InProcessDriver and mpc_node.
class Controller {
 public:
  Controller(std::shared_ptr<Ddm> model, const py::iterable& layers, const py::dict& options)
      : model_(std::move(model)) {
    YAML::Node own(YAML::NodeType::Map);
    own["mpc"] = toYaml(MpcOptions());
    own["controller"] = toYaml(ControllerOptions());
    YAML::Node blocks = mergedBlocks(layers, options, own);
    if (takeOverLimits("mpc", &blocks) == "the default") {
      if (!model_) {
        throw py::value_error(
            "max_torque must be given where there is neither plant nor model: the limit of each "
            "motor [N m]");
      }
      blocks["mpc"]["max_torque"] = valueToYaml(model_->options().max_torque);
    }
    ParamReader reader(blocks);
    options_ = reader.read<MpcOptions>("mpc");
    auto controller = reader.read<ControllerOptions>("controller");
    reader.requireValid();
    const bool one_each = options_.max_torque.size() > 1;
    torque_dim_ = model_     ? model_->torqueDim()
                  : one_each ? static_cast<int>(options_.max_torque.size())
                             : controller.torque_dim;
    limits_ = perMotor(options_.max_torque, torque_dim_, "mpc/max_torque");
    if (model_) policy_ = std::make_shared<MpcPolicy>(model_, options_);
  }

  void reset(const py::object& seed, const py::object& trial) {
    TrialId id;
    id.seed = wholeOf<std::uint64_t>(seed, "seed");
    id.trial = wholeOf<std::uint32_t>(trial, "trial");
    const std::lock_guard<std::mutex> lock(mutex_);
    id_ = id;
    explorer_.reset();
    plan_.reset();
  }

  void setGoal(const py::object& image) {
    const Images goal = Images::single(image, "image");
    const std::lock_guard<std::mutex> lock(mutex_);
    if (policy_) policy_->setGoal(goal.greyValues(0, model_->imageSize()));
  }

  py::array_t<double> act(const py::object& image, bool explore) {
    const Images single = Images::single(image, "image");
    const Image seen = model_ ? single.greyValues(0, model_->imageSize()) : Image();
    Decision decision;
    {
      const py::gil_scoped_release without_gil;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!explorer_) begin(explore);
      if (policy_ && explore == id_.evaluation) {
        throw std::invalid_argument(
            "explore must be the same for all images of an episode: call reset() before the first "
            "image of the next episode");
      }
      decision = explorer_->decide(seen);
      plan_ = decision.plan;
    }
    return arrayOf(decision.torque);
  }

  void applied(const py::object& torque) {
    const Eigen::VectorXd acted = vectorOf(torque, "torque", torque_dim_);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (explorer_) explorer_->correctTorque(acted);
  }

  void startSegment() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (explorer_) explorer_->startSegment();
  }

  py::object planFeatures() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!plan_ || plan_->status == PlanStatus::kFailed) return py::none();
    return rowsOf(plan_->features);
  }

  py::dict options() const { return dictOf(toYaml(options_)); }

 private:
  /// Begins an episode at its first image.
  void begin(bool explore) {
    if (policy_ && !policy_->hasGoal()) {
      throw std::invalid_argument(
          "the goal must be set before the first image, since the model has none: call set_goal()");
    }
    id_.evaluation = policy_ && !explore;
    EpsilonGreedy::Options options;
    options.epsilon = !policy_ ? 1.0 : explore ? options_.epsilon : 0.0;
    options.hold_steps = options_.hold_steps;
    options.max_torque = limits_;
    explorer_.emplace(policy_, options, id_);
  }

  std::shared_ptr<const Ddm> model_;
  MpcOptions options_;
  int torque_dim_ = 1;
  Eigen::VectorXd limits_;
  std::shared_ptr<MpcPolicy> policy_;  // null: all torques are random
  TrialId id_;
  std::optional<EpsilonGreedy> explorer_;  // of this episode; empty before its first image
  std::optional<Plan> plan_;               // of the latest image; empty if its torque is random
  std::mutex mutex_;                       // act() lets other Python threads run
};

}  // namespace

PYBIND11_MODULE(_core, module) {
  py::module::import("ddm_model._core");  // registers the type of models
  using py::arg;
  py::class_<Controller>(module, "Controller")
      .def(py::init<std::shared_ptr<Ddm>, const py::iterable&, const py::dict&>(),
           arg("model").none(true), arg("layers"), arg("options"))
      .def("reset", &Controller::reset, arg("seed") = 0, arg("trial") = 0,
           "Begins an episode: the next image does not follow the last one.\n\n"
           "seed, trial: select the random draws of the episode, both >= 0.")
      .def("set_goal", &Controller::setGoal, arg("image"),
           "Sets the goal image, uint8 [H, W] or [H, W, 3], in place of the model's.\n"
           "Raises TypeError or ValueError.")
      .def("act", &Controller::act, arg("image"), arg("explore") = false,
           "Answers an image with the torque to apply until the next image, [torque_dim, N m].\n\n"
           "image: uint8 [H, W] or [H, W, 3] (red, green, blue). explore: with the probability\n"
           "epsilon, the torque is random; the same for all images of an episode.\n"
           "The first call after set_goal() may take two seconds. Other Python threads run during\n"
           "the call. Raises TypeError or ValueError.")
      .def("applied", &Controller::applied, arg("torque"),
           "Reports the torque that acted, if it differs from that of act() [torque_dim, N m].\n"
           "Call it before the next act(). Raises TypeError or ValueError.")
      .def("start_segment", &Controller::startSegment,
           "Tells that an image was lost, so that the next image is not one time step later.\n"
           "Call it before act().")
      .def_property_readonly(
          "plan_features", &Controller::planFeatures,
          "Feature of the latest image, and those that its plan predicts\n"
          "[horizon + 1, feature_dim]; None if the torque is random or the plan\n"
          "failed")
      .def_property_readonly("options", &Controller::options,
                             "The block `mpc` of the configuration, as a dictionary");
}

}  // namespace ddm
