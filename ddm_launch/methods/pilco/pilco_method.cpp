// PILCO as a method: Gaussian processes and policy search on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_method.h"

#include <ddm_files/plain_file.h>
#include <ddm_model/per_motor.h>
#include <ddm_params/param_value.h>
#include <ddm_params/yaml_text.h>
#include <ddm_pilco/messages.h>
#include <ddm_pilco/rbf_policy.h>
#include <ddm_random/random_stream.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "csv_text.h"
#include "pilco_policy.h"

namespace ddm {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kMemoryFile[] = "pilco.yaml";
constexpr double kDynamicsShare = 0.2;  // of the progress shown

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The file that the previous training left next to the bags of the last trial but one.
/// @param episodes  bags of each trial
std::string memoryFile(const std::vector<std::string>& bags, int episodes) {
  const boost::filesystem::path bag = bags.at(bags.size() - 2 * static_cast<size_t>(episodes));
  return (bag.parent_path() / kMemoryFile).string();
}

/// What the GPs learn from.
struct Transitions {
  Eigen::MatrixXd inputs;   ///< [features of x_t, u_t], one per column
  Eigen::MatrixXd targets;  ///< x_{t+1} - x_t, one per row
};

/// No transition straddles two segments.
Transitions transitions(const DataSet& data, const Eigen::MatrixXd& X,
                        const pilco::Augmentation& features) {
  Eigen::Index count = 0;
  for (const Segment& segment : data.segments()) count += segment.size - 1;
  Transitions out;
  out.inputs.resize(features.outputDim() + data.torqueDim(), count);
  out.targets.resize(count, X.rows());
  Eigen::Index i = 0;
  for (const Segment& segment : data.segments()) {
    for (Eigen::Index t = segment.begin; t + 1 < segment.begin + segment.size; ++t, ++i) {
      out.inputs.col(i) << features.value(X.col(t)), data.torques().col(t);
      out.targets.row(i) = (X.col(t + 1) - X.col(t)).transpose();
    }
  }
  return out;
}

/// A matrix as a list of its columns.
/// @throws std::runtime_error if it is not finite, since matrixOf() would refuse it
YAML::Node matrixToYaml(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) {
    throw std::runtime_error(
        "PILCO: the policy or the GPs that were found are not finite: check the bags, or lower "
        "policy_search/max_iterations or gp/max_iterations");
  }
  YAML::Node out(YAML::NodeType::Sequence);
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    YAML::Node column(YAML::NodeType::Sequence);
    column.SetStyle(YAML::EmitterStyle::Flow);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) column.push_back(valueToYaml(matrix(i, j)));
    out.push_back(column);
  }
  return out;
}

/// @param max_numbers  that can be there at all: aliases would make much of little
Eigen::MatrixXd matrixOf(const YAML::Node& memory, const std::string& key, size_t max_numbers) {
  const YAML::Node columns = memory[key];
  if (!columns.IsDefined() || !columns.IsSequence()) {
    throw std::runtime_error(key + " must be a list of columns");
  }
  const auto rows = columns.size() == 0 ? 0 : columns[0].size();
  if (columns.size() > 0 && rows > max_numbers / columns.size()) {
    throw std::runtime_error(key + " is longer than the file");
  }
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j) {
    if (!columns[j].IsSequence() || columns[j].size() != rows)
      throw std::runtime_error(key + " must have columns of one size");
    for (size_t i = 0; i < rows; ++i) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = columns[j][i].as<double>();
    }
  }
  if (!out.allFinite()) throw std::runtime_error(key + " must be finite");
  return out;
}

/// The single column that a vector is kept as.
Eigen::VectorXd vectorOf(const YAML::Node& memory, const std::string& key, size_t max_numbers) {
  const Eigen::MatrixXd matrix = matrixOf(memory, key, max_numbers);
  if (matrix.cols() != 1) throw std::runtime_error(key + " must be one column");
  return matrix.col(0);
}

void requireParameters(const Eigen::VectorXd& parameters, const pilco::SquashedPolicy& policy,
                       const std::string& file) {
  if (parameters.size() == policy.numParameters()) return;
  throw std::runtime_error(pilco::message(file, ": policy must have ", policy.numParameters(),
                                          " parameters, got ", parameters.size(),
                                          ": use another run folder"));
}

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
  const int episodes = configuration_.trial.episodes;
  if (bags.size() < 2 * static_cast<size_t>(episodes) || !observation_->keepsCoordinates()) {
    return {};
  }
  const std::string file = memoryFile(bags, episodes);
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

  pilco::LongTermCost cost = improvePolicy(std::move(dynamics), task, bags, &training);
  writeMemory(training.memory, &training.report);

  TrainingOutcome outcome;
  outcome.files = observation_->files();
  outcome.files[kMemoryFile] = YAML::Dump(training.report) + "\n";
  outcome.files["prediction.csv"] = predictionCsv(cost);
  outcome.frames = static_cast<std::uint32_t>(data.numFrames());
  outcome.evaluations = training.report["evaluations"].as<std::uint32_t>();
  outcome.seconds = secondsSince(start);
  return outcome;
}

bool PilcoMethod::resume(const std::string& folder, const std::vector<std::string>& bags,
                         const TrialId& id) {
  const std::string file = folder + "/" + kMemoryFile;
  if (!boost::filesystem::exists(file)) return false;
  const PilcoMemory memory = readMemory(readFile(file), file);
  const DataSet data = bags_.read(bags);
  observation_->resume(folder, bags, data, id);
  const auto features = pilco::replaceAngles(static_cast<int>(observation_->names().size()),
                                             observation_->task().angles);
  makePolicy(features.outputDim(), data.torqueDim());
  requireParameters(memory.policy, *policy_, file);
  policy_->setParameters(memory.policy);
  return true;
}

void PilcoMethod::makePolicy(int num_features, int torque_dim) {
  policy_ = std::make_shared<pilco::SquashedPolicy>(
      std::make_unique<pilco::RbfPolicy>(num_features, torque_dim, pilco_.pilco.num_centres),
      perMotor(configuration_.mpc.max_torque, torque_dim, "mpc/max_torque"));
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

/// Sets policy_. Where the last policy's prediction leaves the finite numbers under the new GPs,
/// the search starts afresh, and where that is no better the run goes on with what there is: an
/// error would come again each time that it is resumed.
/// @return the cost, evaluated at the policy
pilco::LongTermCost PilcoMethod::improvePolicy(pilco::Propagation dynamics, const PilcoTask& task,
                                               const std::vector<std::string>& bags,
                                               Training* training) {
  const Clock::time_point start = Clock::now();
  const pilco::Augmentation features = dynamics.features();
  const int torque_dim = dynamics.controlDim();
  const int num_centres = pilco_.pilco.num_centres;
  makePolicy(features.outputDim(), torque_dim);
  const auto drawStart = [&] {
    return drawPolicyStart(task, features, num_centres, torque_dim, &training->rng);
  };
  Eigen::VectorXd& parameters = training->memory.policy;
  if (parameters.size() == 0) {
    parameters = drawStart();
  } else {
    requireParameters(parameters, *policy_, memoryFile(bags, configuration_.trial.episodes));
  }
  pilco::LongTermCost cost(std::move(dynamics), task.cost, policy_.get(), task.start,
                           pilco_.pilco.horizon);
  int evaluations = 0;
  const auto search = [&] {
    return pilco::searchPolicy(
        [&](const Eigen::VectorXd& p, Eigen::VectorXd* gradient) {
          // The line search takes about two evaluations an iteration.
          const double done = ++evaluations / (2.0 * pilco_.policy_search.max_iterations + 1.0);
          training->progress(kDynamicsShare + (1.0 - kDynamicsShare) * std::min(done, 1.0));
          return cost.evaluate(p, gradient);
        },
        parameters, pilco_.policy_search);
  };
  Minimum result = search();
  const bool afresh = result.reason == MinimumReason::kStartFailed;
  if (afresh) {
    parameters = drawStart();
    result = search();
  }
  const bool failed = result.reason == MinimumReason::kStartFailed;
  if (failed) {  // more data may mend it
    result.message = "a first policy is kept, since its cost is not finite either";
  }
  parameters = result.x;
  cost.evaluate(parameters);  // sets the policy, and the prediction that is kept

  YAML::Node& report = training->report;
  report["policy_search_s"] = valueToYaml(secondsSince(start));
  report["iterations"] = result.iterations;
  report["evaluations"] = result.evaluations;
  report["cost_before"] = failed ? YAML::Node() : valueToYaml(result.initial_cost);
  report["cost_after"] = failed ? YAML::Node() : valueToYaml(result.cost);
  report["message"] =
      (afresh ? "started afresh, the last policy's cost is not finite; " : "") + result.message;
  return cost;
}

std::string PilcoMethod::predictionCsv(const pilco::LongTermCost& cost) const {
  std::vector<std::string> columns;
  for (const std::string& name : observation_->names()) {
    for (const char* measure : {"_mean", "_std"}) columns.push_back(name + measure);
  }
  std::string text = csvLine("step", "time_s", columns, "cost_mean", "cost_std");
  const std::vector<double> cost_std = cost.costStandardDeviations();
  for (size_t step = 0; step < cost.states().size(); ++step) {
    const pilco::Gaussian& state = cost.states()[step];
    std::vector<std::string> cells;
    for (Eigen::Index i = 0; i < state.mean.size(); ++i) {
      cells.push_back(csvCell(state.mean[i]));
      cells.push_back(csvCell(std::sqrt(std::max(0.0, state.covariance(i, i)))));
    }
    const auto of_step = [step](const std::vector<double>& values) {
      return step == 0 ? std::string() : csvCell(values[step - 1]);
    };
    text += csvLine(step, static_cast<double>(step) * configuration_.plant_info.dt, cells,
                    of_step(cost.costs()), of_step(cost_std));
  }
  return text;
}

std::shared_ptr<Policy> PilcoMethod::policy() const {
  if (policy_ == nullptr) return nullptr;
  return std::make_shared<PilcoPolicy>(observation_, policy_, observation_->task().angles);
}

void writeMemory(const PilcoMemory& memory, YAML::Node* out) {
  (*out)["policy"] = matrixToYaml(memory.policy);
  (*out)["log_length_scales"] = matrixToYaml(memory.gps.hyperparameters.log_length_scales);
  (*out)["log_signal_std"] = matrixToYaml(memory.gps.hyperparameters.log_signal_std);
  (*out)["log_noise_std"] = matrixToYaml(memory.gps.hyperparameters.log_noise_std);
  (*out)["inducing"] = matrixToYaml(memory.gps.inducing);
}

PilcoMemory readMemory(const std::string& text, const std::string& source) {
  try {
    const YAML::Node root = parseYaml(text, source);
    if (!root.IsMap()) throw std::runtime_error("must be a map");
    PilcoMemory memory;
    memory.policy = vectorOf(root, "policy", text.size());
    memory.gps.hyperparameters = {matrixOf(root, "log_length_scales", text.size()),
                                  vectorOf(root, "log_signal_std", text.size()),
                                  vectorOf(root, "log_noise_std", text.size())};
    memory.gps.inducing = matrixOf(root, "inducing", text.size());
    return memory;
  } catch (const std::exception& e) {
    throw std::runtime_error(source + ": " + e.what() +
                             ": PILCO goes on from this file, so use another run folder");
  }
}

}  // namespace ddm
