// PILCO as a method: Gaussian processes and policy search on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_method.h"

#include <ddm_model/model_file.h>
#include <ddm_mpc/random_stream.h>
#include <ddm_msgs/param_value.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "csv_text.h"
#include "pilco_policy.h"
#include "policy_start.h"

namespace ddm {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kMemoryFile[] = "pilco.yaml";
constexpr double kDynamicsShare = 0.2;  // of the progress shown

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What the GPs learn from.
struct Transitions {
  Eigen::MatrixXd inputs;   ///< [features of x_t, u_t], one per column
  Eigen::MatrixXd targets;  ///< x_{t+1} - x_t, one per row
};

/// No transition straddles two pieces.
Transitions transitions(const DataSet& data, const Eigen::MatrixXd& X,
                        const pilco::Augmentation& features) {
  Eigen::Index count = 0;
  for (const Piece& piece : data.pieces()) count += piece.size - 1;
  Transitions out;
  out.inputs.resize(features.outputDim() + data.torqueDim(), count);
  out.targets.resize(count, X.rows());
  Eigen::Index i = 0;
  for (const Piece& piece : data.pieces()) {
    for (Eigen::Index t = piece.begin; t + 1 < piece.begin + piece.size; ++t, ++i) {
      out.inputs.col(i) << features.value(X.col(t)), data.torques().col(t);
      out.targets.row(i) = (X.col(t + 1) - X.col(t)).transpose();
    }
  }
  return out;
}

std::string cell(double value) { return "," + formatDouble(value); }

}  // namespace

/// What a training needs and how it goes.
struct PilcoMethod::Training {
  PilcoMemory memory;
  std::mt19937_64 rng;
  PhaseCallback progress;
  YAML::Node report{YAML::NodeType::Map};
};

PilcoMethod::PilcoMethod(const Configuration& configuration, const PilcoConfig& pilco,
                         std::unique_ptr<Observation> observation)
    : configuration_(configuration),
      pilco_(pilco),
      observation_(std::move(observation)),
      bags_(configuration.model.image.size, configuration.model.data_set) {}

PilcoMemory PilcoMethod::lastMemory(const std::vector<std::string>& bags) const {
  if (bags.size() < 2 || !observation_->keepsCoordinates()) return {};
  const boost::filesystem::path last_bag = bags[bags.size() - 2];
  const std::string file = (last_bag.parent_path() / kMemoryFile).string();
  return readMemory(readFile(file), file);
}

TrainingOutcome PilcoMethod::train(const std::vector<std::string>& bags, const TrialId& id,
                                   const PhaseCallback& progress) {
  const Clock::time_point start = Clock::now();
  Training training{lastMemory(bags), randomStream(id, StreamRole::kPolicySearch), progress};
  const DataSet data = bags_.read(bags);
  const Eigen::MatrixXd X = observation_->learn(bags, data, id);
  const PilcoTask task = observation_->task();
  pilco::Propagation dynamics = learnDynamics(data, X, task, &training);

  const Clock::time_point search_start = Clock::now();
  policy_ =
      makePilcoPolicy(dynamics.featureDim(), pilco_.pilco.num_centres,
                      Eigen::VectorXd::Constant(data.torqueDim(), configuration_.mpc.max_torque));
  Eigen::VectorXd& parameters = training.memory.policy;
  if (parameters.size() == 0) {
    parameters = drawPolicyStart(task, dynamics.features(), pilco_.pilco.num_centres,
                                 data.torqueDim(), &training.rng);
  }
  pilco::LongTermCost cost(std::move(dynamics), task.cost, policy_.get(), task.start,
                           pilco_.pilco.horizon);
  int evaluations = 0;
  const pilco::PolicySearchResult result = pilco::searchPolicy(
      [&](const Eigen::VectorXd& p, Eigen::VectorXd* gradient) {
        // The line search takes about two evaluations an iteration.
        const double done = ++evaluations / (2.0 * pilco_.policy_search.max_iterations + 1.0);
        progress(kDynamicsShare + (1.0 - kDynamicsShare) * std::min(done, 1.0));
        return cost.evaluate(p, gradient);
      },
      parameters, pilco_.policy_search);
  if (!result.ok) {
    throw std::runtime_error(
        "PILCO: the long-term cost of the policy before its improvement is "
        "not finite: pilco/horizon may be too long for these dynamics");
  }
  parameters = result.parameters;
  cost.evaluate(parameters);  // sets the policy, and the prediction that is kept

  YAML::Node& report = training.report;
  report["policy_search_s"] = valueToYaml(secondsSince(search_start));
  report["iterations"] = result.iterations;
  report["evaluations"] = result.evaluations;
  report["cost_before"] = valueToYaml(result.cost_before);
  report["cost_after"] = valueToYaml(result.cost_after);
  report["message"] = result.message;
  writeMemory(training.memory, &report);

  TrainingOutcome outcome;
  outcome.files = observation_->files();
  outcome.files[kMemoryFile] = YAML::Dump(report) + "\n";
  outcome.files["prediction.csv"] = predictionCsv(cost);
  outcome.frames = static_cast<std::uint32_t>(data.numFrames());
  outcome.evaluations = static_cast<std::uint32_t>(result.evaluations);
  outcome.seconds = secondsSince(start);
  return outcome;
}

pilco::Propagation PilcoMethod::learnDynamics(const DataSet& data, const Eigen::MatrixXd& X,
                                              const PilcoTask& task, Training* training) const {
  const Clock::time_point start = Clock::now();
  const pilco::Augmentation features =
      pilco::replaceAngles(static_cast<int>(X.rows()), task.angles);
  const Transitions seen = transitions(data, X, features);
  pilco::GpLearner learner(pilco_.gp, pilco_.sparse_gp, training->memory.gps);
  int evaluations = 0;
  const pilco::GpFit fit = learner.learn(seen.inputs, seen.targets, &training->rng, [&] {
    const double most = static_cast<double>(X.rows()) * pilco_.gp.max_iterations;
    training->progress(kDynamicsShare * std::min(1.0, ++evaluations / most));
  });
  if (!fit.ok) throw std::runtime_error("PILCO: the GPs could not be trained: " + fit.message);
  training->memory.gps = learner.state();
  training->report["points"] = static_cast<int>(seen.inputs.cols());
  training->report["sparse"] = seen.inputs.cols() > pilco_.sparse_gp.max_points;
  training->report["gp_s"] = valueToYaml(secondsSince(start));
  training->report["gp_message"] = fit.message;
  pilco::PropagationOptions options;
  options.angles = task.angles;
  options.noisy_policy_input = pilco_.pilco.noisy_policy_input;
  return pilco::Propagation(fit.model, options);
}

std::string PilcoMethod::predictionCsv(const pilco::LongTermCost& cost) const {
  std::string text = "step,time_s";
  for (const std::string& name : observation_->names()) {
    text += "," + name + "_mean," + name + "_std";
  }
  text += ",cost_mean,cost_std\n";
  const std::vector<double> cost_std = cost.costStandardDeviations();
  for (size_t step = 0; step < cost.states().size(); ++step) {
    const pilco::Gaussian& state = cost.states()[step];
    text += std::to_string(step) + cell(static_cast<double>(step) * configuration_.plant.dt);
    for (Eigen::Index i = 0; i < state.mean.size(); ++i) {
      text += cell(state.mean[i]) + cell(std::sqrt(std::max(0.0, state.covariance(i, i))));
    }
    text += step == 0 ? ",," : cell(cost.costs()[step - 1]) + cell(cost_std[step - 1]);
    text += "\n";
  }
  return text;
}

std::shared_ptr<Policy> PilcoMethod::policy() const {
  if (policy_ == nullptr) return nullptr;
  return std::make_shared<PilcoPolicy>(observation_, policy_, observation_->task().angles);
}

}  // namespace ddm
