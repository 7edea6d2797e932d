// PILCO's observations: the true state, an auto-encoder's features, principal components.
// SPDX-License-Identifier: BSD-3-Clause
#include "observations.h"

#include <ddm_common/plain_file.h>
#include <ddm_common/random_stream.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>
#include <ddm_pilco/gp.h>
#include <ddm_sim/angles.h>

#include <Eigen/Eigenvalues>
#include <boost/filesystem.hpp>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "tables.h"

namespace ddm {
namespace {

constexpr char kModelFile[] = "model.ddm";
constexpr int kRate = 0;  // places in x
constexpr int kAngle = 1;
constexpr double kUprightWithin = 1e-9;  // [rad]
// As in the published runs.
constexpr double kCostWidth = 0.5;    // of the saturating cost around the goal [spread]
constexpr double kRateNoise = 0.1;    // true state: standard deviation of its measurement [rad/s]
constexpr double kAngleNoise = 0.01;  // the same [rad]
constexpr double kStartStd = 0.1;     // images: standard deviation of the initial state [spread]

/// (angle, rate) of the plant to x.
Eigen::VectorXd reorder(const Eigen::VectorXd& state) { return state.reverse(); }

/// One joint that turns, seen as angle and rate, whose goal is upright: what the cost is made for.
bool isPendulum(const Plant& plant) {
  const PlantInfo& info = plant.info();
  return info.joints.size() == 1 && info.joints[0].kind == JointKind::kAngle &&
         info.stateDim() == 2 &&
         std::abs(std::remainder(info.goal[0] - kPi, 2.0 * kPi)) <= kUprightWithin;
}

pilco::Gaussian startDistribution(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                                  double distance) {
  const Eigen::Index dim = X.rows();
  Eigen::MatrixXd first(dim, static_cast<Eigen::Index>(segments.size()));
  for (size_t i = 0; i < segments.size(); ++i) {
    first.col(static_cast<Eigen::Index>(i)) = X.col(segments[i].begin);
  }
  const Eigen::VectorXd mean = first.rowwise().mean();
  const Eigen::MatrixXd centred = first.colwise() - mean;
  const Eigen::MatrixXd scatter =
      centred * centred.transpose() +
      distance * distance / static_cast<double>(dim) * Eigen::MatrixXd::Identity(dim, dim);
  return {mean, scatter / static_cast<double>(segments.size())};
}

}  // namespace

TrueStateObservation::TrueStateObservation(const Plant& plant) : plant_(plant) {
  pilco::require(
      isPendulum(plant),
      "PILCO on the true state is for one joint with angle and rate whose goal is the angle pi; "
      "this plant has ",
      plant.info().joints.size(), " joint(s), ", plant.stateDim(),
      " state component(s) and the goal [", plant.info().goal.transpose(),
      "]: use method pilco_features or pilco_pca");
}

std::vector<std::string> TrueStateObservation::names() const {
  const std::vector<std::string>& of_plant = plant_.info().state_names;
  return {of_plant[1], of_plant[0]};
}

Eigen::MatrixXd TrueStateObservation::learn(const std::vector<std::string>& bags,
                                            const DataSet& data, const TrialId& id) {
  Eigen::MatrixXd X(2, data.numFrames());
  Eigen::Index frame = 0;
  for (size_t trial = 0; trial < bags.size(); ++trial) {
    const std::string file =
        (boost::filesystem::path(bags[trial]).parent_path() / "trajectory.csv").string();
    const Eigen::MatrixXd states =
        parseTrajectoryCsv(readFile(file), plant_.info().state_names, file);
    const Eigen::Index due = trial < data.segments().size() ? data.segments()[trial].size : 0;
    if (states.cols() != due) {
      throw std::runtime_error(pilco::message(file, " must have the ", due,
                                              " frames of the bag beside it, got ", states.cols(),
                                              ": the run folder is damaged, use another"));
    }
    startTrial({id.seed, static_cast<std::uint32_t>(trial), false});
    for (Eigen::Index i = 0; i < states.cols(); ++i) X.col(frame++) = measure(states.col(i));
  }
  return X;
}

PilcoTask TrueStateObservation::task() const {
  const Eigen::VectorXd variance = reorder(plant_.info().start_std).cwiseAbs2();
  const pilco::Gaussian start{reorder(plant_.info().start), variance.asDiagonal()};
  Eigen::VectorXd length_scales(3);  // of rate, sine, cosine, as in the published runs
  length_scales << 1.0, 0.7, 0.7;
  // Distance and width are in lengths of the rod, so no rod needs to be known.
  return {{kAngle}, true, start, pilco::pendulumCost(/*length=*/1.0, kCostWidth), length_scales};
}

void TrueStateObservation::startTrial(const TrialId& id) {
  noise_ = randomStream(id, StreamRole::kMeasurement);
}

Eigen::VectorXd TrueStateObservation::observe(const Grey& /*grey*/) {
  return measure(plant_.state());
}

Eigen::VectorXd TrueStateObservation::measure(const Eigen::VectorXd& state) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd x = reorder(state);
  x[kRate] += kRateNoise * normal(noise_);
  x[kAngle] += kAngleNoise * normal(noise_);
  return x;
}

PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                    const Eigen::VectorXd& goal) {
  const Eigen::VectorXd std = pilco::sampleStd(X);
  const double spread = std.norm();
  if (!(spread > 0.0)) throw std::runtime_error("all images are observed as the same state");
  const int dim = static_cast<int>(X.rows());
  const double width = kCostWidth * spread;
  const Eigen::MatrixXd weight = Eigen::MatrixXd::Identity(dim, dim) / (width * width);
  return {{},
          false,
          startDistribution(X, segments, kStartStd * spread),
          pilco::StateCost(pilco::replaceAngles(dim, {}), pilco::SaturatingCost(goal, weight)),
          std};
}

FeatureObservation::FeatureObservation(const ModelConfig& model) : ImageObservation(model) {
  pilco::require(config_.training.schedule == "v_r_only",
                 "training/schedule must be v_r_only where PILCO learns the dynamics, got ",
                 config_.training.schedule);
}

std::vector<std::string> FeatureObservation::names() const {
  return featureNames(config_.model.feature_dim);
}

Eigen::MatrixXd FeatureObservation::learn(const std::vector<std::string>& /*bags*/,
                                          const DataSet& data, const TrialId& id) {
  ModelInfo info;
  info.seed = id.seed;
  info.trial = id.trial;
  info.config = toText(config_);
  const TrainingResult result = train(data, config_.model, config_.training, info);
  if (!result.model) throw std::runtime_error("auto-encoder: " + result.message);
  model_ = *result.model;
  return observeAll(data);
}

void FeatureObservation::resume(const std::string& folder, const std::vector<std::string>& /*bags*/,
                                const DataSet& data, const TrialId& /*id*/) {
  const std::string file = folder + "/" + kModelFile;
  model_ = deserialiseModel(readFile(file), file);
  observeAll(data);
}

/// Sets task_. @return features of all frames  [feature_dim x N]
Eigen::MatrixXd FeatureObservation::observeAll(const DataSet& data) {
  const Eigen::MatrixXd Z = encodeAll(*model_, data);
  task_ = imageTask(Z, data.segments(), model_->goalFeature());
  return Z;
}

std::map<std::string, std::string> FeatureObservation::files() const {
  return {{kModelFile, serialiseModel(*model_)}};
}

std::vector<std::string> PcaObservation::names() const {
  return featureNames(config_.model.pca_dim);
}

Eigen::MatrixXd PcaObservation::learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                                      const TrialId& /*id*/) {
  const Pca pca = fitPca(data, config_.model.pca_dim, Blur(data.imageSize(), config_.model.blur));
  projection_ = Projection(pca);
  const Eigen::MatrixXd Z = pca.project(data).leftCols(data.numFrames()).cast<double>();
  if (!data.hasGoal())
    throw std::runtime_error(
        "the bags hold no goal image, which tells the goal: record one on goal_image");
  task_ = imageTask(Z, data.segments(), observe(data.goal()));
  return Z;
}

Answer PilcoPolicy::answer() {
  const auto start = std::chrono::steady_clock::now();
  Answer answer;
  answer.torque = policy_->control(features_.value(x_));
  if (!answer.torque.allFinite()) answer.torque.setZero();
  answer.solve_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng) {
  constexpr double kTargetStd = 0.1;  // of the published runs
  const auto drawNormal = [rng](Eigen::Index rows, Eigen::Index cols) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd out(rows, cols);
    for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(*rng);
    return out;
  };
  const pilco::Moments start = features.predict(task.start);
  // A root of the covariance, which may be singular.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(start.covariance);
  const Eigen::MatrixXd root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd centres =
      (root * drawNormal(start.mean.size(), num_centres)).colwise() + start.mean;
  const Eigen::MatrixXd targets = kTargetStd * drawNormal(num_centres, torque_dim);
  const Eigen::MatrixXd log_length_scales =
      task.policy_length_scales.array().log().matrix().replicate(1, torque_dim);
  return pilco::RbfPolicy::packParameters(log_length_scales, centres, targets);
}

}  // namespace ddm
