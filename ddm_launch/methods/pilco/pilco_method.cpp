// PILCO as a method: Gaussian processes of the dynamics and policy search, on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/pilco_method.h"

#include <ddm_bag_io/bag_cache.h>
#include <ddm_common/param_value.h>
#include <ddm_common/random_stream.h>
#include <ddm_model/minimise.h>
#include <ddm_model/per_motor.h>
#include <ddm_sim/plant.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/filesystem.hpp>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "pilco/long_term_cost.h"
#include "pilco/pilco_memory.h"
#include "tables.h"

namespace ddm {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kMemoryFile[] = "pilco.yaml";
constexpr double kDynamicsShare = 0.2;  // share of the GP training in the progress bar
// Values of the published experiments.
constexpr int kNumCentres = 30;    // basis functions of the RBF policy
constexpr int kLineSearches = 75;  // limit on the iterations of each policy search

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Training data of the GPs: inputs [features of x_t, u_t] in columns, targets x_{t+1} - x_t in
/// rows. Both states of a transition are in the same segment.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> transitions(const DataSet& data,
                                                        const Eigen::MatrixXd& X,
                                                        const pilco::Augmentation& features) {
  Eigen::Index i = 0, count = 0;
  for (const Segment& segment : data.segments()) count += segment.size - 1;
  Eigen::MatrixXd inputs(features.outputDim() + data.torqueDim(), count), targets(count, X.rows());
  for (const Segment& segment : data.segments()) {
    for (Eigen::Index t = segment.begin; t + 1 < segment.begin + segment.size; ++t, ++i) {
      inputs.col(i) << features.value(X.col(t)), data.torques().col(t);
      targets.row(i) = (X.col(t + 1) - X.col(t)).transpose();
    }
  }
  return {inputs, targets};
}

/// Draws the parameters of the first RBF policy. The centres are drawn from the features of p(x_0),
/// which are approximated by a Gaussian; the targets are small random numbers; the length-scales
/// are those of the task.
/// @param features  features of the task's state
Eigen::VectorXd drawFirstPolicy(const PilcoTask& task, const pilco::Augmentation& features,
                                int torque_dim, std::mt19937_64* rng) {
  constexpr double kTargetStd = 0.1;  // value of the published experiments
  const auto drawNormal = [rng](Eigen::Index rows, Eigen::Index cols) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd out(rows, cols);
    for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(*rng);
    return out;
  };
  const pilco::Moments start = features.predict(task.start);
  // A square root of the covariance. A Cholesky factor may not exist, as the covariance may be
  // singular.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(start.covariance);
  const Eigen::MatrixXd root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd centres =
      (root * drawNormal(start.mean.size(), kNumCentres)).colwise() + start.mean;
  const Eigen::MatrixXd targets = kTargetStd * drawNormal(kNumCentres, torque_dim);
  const Eigen::MatrixXd log_length_scales =
      task.policy_length_scales.array().log().matrix().replicate(1, torque_dim);
  return pilco::RbfPolicy::packParameters(log_length_scales, centres, targets);
}

/// Content of prediction.csv.
/// @param names  of the entries of x
/// @param dt     time step [s]
std::string predictionCsv(const std::vector<std::string>& names, double dt,
                          const pilco::LongTermCost& cost) {
  std::vector<std::string> columns;
  for (const std::string& name : names) {
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
    text += csvLine(step, static_cast<double>(step) * dt, cells, of_step(cost.costs()),
                    of_step(cost_std));
  }
  return text;
}

/// The policy of PILCO on an observation: u = policy(features of x).
class PilcoPolicy : public Policy {
 public:
  PilcoPolicy(std::shared_ptr<Observation> observation, std::shared_ptr<pilco::RbfPolicy> policy,
              pilco::Augmentation features)
      : observation_(std::move(observation)),
        policy_(std::move(policy)),
        features_(std::move(features)) {}

  void startTrial(const TrialId& id) override { observation_->startTrial(id); }
  void observe(const Image& image) override { x_ = observation_->observe(image); }
  /// The torque is 0 if the policy's result is not finite.
  Answer answer() override {
    const Clock::time_point start = Clock::now();
    Answer answer;
    answer.torque = policy_->control(features_.value(x_));
    if (!answer.torque.allFinite()) answer.torque.setZero();
    answer.solve_time = secondsSince(start);
    return answer;
  }
  void apply(const Eigen::VectorXd& /*u*/) override {}

 private:
  std::shared_ptr<Observation> observation_;
  std::shared_ptr<pilco::RbfPolicy> policy_;
  pilco::Augmentation features_;
  Eigen::VectorXd x_;
};

/// Inputs and statistics of one training.
struct Training {
  pilco::Memory memory;
  std::mt19937_64 rng;
  PhaseCallback progress;
  YAML::Node report{YAML::NodeType::Map};
};

class PilcoMethod : public Method {
 public:
  PilcoMethod(const Configuration& configuration, const pilco::PilcoOptions& options,
              std::unique_ptr<Observation> observation)
      : configuration_(configuration),
        options_(options),
        observation_(std::move(observation)),
        bags_(configuration.model.image.size, configuration.model.data_set) {}

  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override {
    const Clock::time_point start = Clock::now();
    const DataSet data = bags_.read(bags);
    const ObservedData observed = observation_->learn(bags, data, id);
    makePolicy(observed, data.torqueDim());
    Training training{lastMemory(bags), randomStream(id, StreamRole::kPolicySearch), progress};
    pilco::Propagation dynamics = learnDynamics(data, observed, &training);
    const pilco::LongTermCost cost = improvePolicy(std::move(dynamics), observed.task, &training);
    pilco::addMemory(training.memory, &training.report);

    TrainingOutcome outcome;
    outcome.files = observation_->files();
    outcome.files[kMemoryFile] = YAML::Dump(training.report) + "\n";
    outcome.files["prediction.csv"] =
        predictionCsv(observation_->names(), configuration_.plant_info.dt, cost);
    outcome.frames = static_cast<std::uint32_t>(data.numFrames());
    outcome.evaluations = training.report["evaluations"].as<std::uint32_t>();
    outcome.seconds = secondsSince(start);
    return outcome;
  }

  bool resume(const std::string& folder, const std::vector<std::string>& bags,
              const TrialId& id) override {
    const std::string file = folder + "/" + kMemoryFile;
    if (!boost::filesystem::exists(file)) return false;
    const DataSet data = bags_.read(bags);
    makePolicy(observation_->resume(folder, bags, data, id), data.torqueDim());
    policy_->setParameters(readMemory(file).policy);
    return true;
  }

  std::shared_ptr<Policy> policy() const override {
    if (policy_ == nullptr) return nullptr;
    return std::make_shared<PilcoPolicy>(observation_, policy_, *features_);
  }

 private:
  pilco::Memory readMemory(const std::string& file) const {
    return pilco::readMemory(file, *policy_, features_->inputDim());
  }

  /// Reads the memory of the previous training, which is in the folder of the last trial but one.
  pilco::Memory lastMemory(const std::vector<std::string>& bags) const {
    const size_t last_two_trials = 2 * static_cast<size_t>(configuration_.trial.episodes);
    if (bags.size() < last_two_trials || !observation_->keepsCoordinates()) return {};
    const boost::filesystem::path bag = bags[bags.size() - last_two_trials];
    return readMemory((bag.parent_path() / kMemoryFile).string());
  }

  void makePolicy(const ObservedData& observed, int torque_dim) {
    features_ = pilco::replaceAngles(static_cast<int>(observed.X.rows()), observed.task.angles);
    policy_ = std::make_shared<pilco::RbfPolicy>(
        features_->outputDim(), kNumCentres,
        perMotor(configuration_.mpc.max_torque, torque_dim, "mpc/max_torque"));
  }

  pilco::Propagation learnDynamics(const DataSet& data, const ObservedData& observed,
                                   Training* training) const {
    const Clock::time_point start = Clock::now();
    const auto [inputs, targets] = transitions(data, observed.X, *features_);
    int evaluations = 0;
    const auto count = [&] {
      const double most =
          static_cast<double>(observed.X.rows()) * options_.hyperparameter_iterations;
      training->progress(kDynamicsShare * std::min(1.0, ++evaluations / most));
    };
    const pilco::GpFit fit =
        pilco::learnGp(options_, inputs, targets, &training->rng, &training->memory.gps, count);
    if (!fit.ok()) throw std::runtime_error("PILCO: the GPs could not be trained: " + fit.message);
    training->report["points"] = static_cast<int>(inputs.cols());
    training->report["sparse"] = inputs.cols() > options_.max_points;
    training->report["gp_s"] = valueToYaml(secondsSince(start));
    training->report["gp_message"] = fit.message;
    return pilco::Propagation(fit.model, observed.task.angles, observed.task.noisy);
  }

  /// Searches the policy and sets policy_. If the cost of the last policy is not finite under the new
  /// GPs, the search starts from a newly drawn policy. If the cost of that policy is not finite
  /// either, that policy is kept without a search: an error would end the experiment, and resuming
  /// the experiment would only repeat the error.
  /// @return the long-term cost, evaluated at the policy
  pilco::LongTermCost improvePolicy(pilco::Propagation dynamics, const PilcoTask& task,
                                    Training* training) {
    const Clock::time_point start = Clock::now();
    const auto drawStart = [&] {
      return drawFirstPolicy(task, *features_, policy_->outputDim(), &training->rng);
    };
    Eigen::VectorXd& parameters = training->memory.policy;
    if (parameters.size() == 0) parameters = drawStart();
    pilco::LongTermCost cost(std::move(dynamics), task.cost, policy_.get(), task.start,
                             /*horizon=*/configuration_.trial.num_steps);
    int evaluations = 0;
    MinimiseOptions solver;
    solver.max_iterations = kLineSearches;
    solver.max_evaluations = options_.policy_evaluations;
    solver.function_tolerance = 1e-8;
    const auto search = [&] {
      // The cost is not finite if a predicted distribution grows without bound. The line search then
      // takes a shorter step.
      return minimise(
          [&](const Eigen::VectorXd& p, Eigen::VectorXd* gradient) {
            // A line search takes about two evaluations.
            const double done = ++evaluations / (2.0 * kLineSearches + 1.0);
            training->progress(kDynamicsShare + (1.0 - kDynamicsShare) * std::min(done, 1.0));
            return cost.evaluate(p, gradient);
          },
          parameters, solver);
    };
    SolverResult result = search();
    const bool afresh = result.reason == TerminationReason::kStartFailed;
    if (afresh) {
      parameters = drawStart();
      result = search();
    }
    const bool failed = result.reason == TerminationReason::kStartFailed;
    if (failed) {  // the next trial adds data, which may help
      result.message = "a first policy is kept, since its cost is not finite either";
    }
    parameters = result.x;
    cost.evaluate(parameters);  // sets the parameters of the policy and the stored prediction

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

  const Configuration& configuration_;
  pilco::PilcoOptions options_;
  std::shared_ptr<Observation> observation_;
  BagCache bags_;
  std::optional<pilco::Augmentation> features_;  // maps x to the input of the policy
  std::shared_ptr<pilco::RbfPolicy> policy_;     // null before the first training
};

MethodKind pilcoKind(const std::string& name, const std::string& about,
                     std::unique_ptr<Observation> (*observe)(const Configuration&, const Plant&)) {
  const auto read_blocks = [](ParamReader* reader) {
    YAML::Node out;
    out["pilco"] = toYaml(reader->read<pilco::PilcoOptions>("pilco"));
    return out;
  };
  const auto make = [observe](const Configuration& all, const Plant& plant) {
    pilco::require(
        !(all.camera.drop_rate > 0.0),
        "camera/drop_rate must be 0 with PILCO, which takes a segment of its data without "
        "a gap for a trial, got ",
        all.camera.drop_rate);
    ParamReader reader(all.method_blocks);
    return makePilcoMethod(all, reader.read<pilco::PilcoOptions>("pilco"), observe(all, plant));
  };
  return {name, "PILCO on " + about, read_blocks, make};
}

}  // namespace

std::unique_ptr<Method> makePilcoMethod(const Configuration& configuration,
                                        const pilco::PilcoOptions& options,
                                        std::unique_ptr<Observation> observation) {
  return std::make_unique<PilcoMethod>(configuration, options, std::move(observation));
}

std::vector<MethodKind> pilcoMethods() {
  return {pilcoKind("pilco_state", "the true state", observeTrueState),
          pilcoKind("pilco_features", "features of an auto-encoder that is trained alone",
                    observeFeatures),
          pilcoKind("pilco_pca", "principal components of the image", observePrincipalComponents)};
}

}  // namespace ddm
