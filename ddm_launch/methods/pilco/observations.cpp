// PILCO's observations: the true state, an auto-encoder's features, principal components.
// SPDX-License-Identifier: BSD-3-Clause
#include "observations.h"

#include <ddm_files/plain_file.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>
#include <ddm_pilco/gp_training.h>
#include <ddm_pilco/messages.h>
#include <ddm_random/random_stream.h>
#include <ddm_sim/angles.h>

#include <boost/filesystem.hpp>
#include <cmath>
#include <stdexcept>

#include "csv_text.h"
#include "run_csv.h"

namespace ddm {
namespace {

constexpr char kModelFile[] = "model.ddm";
constexpr int kRate = 0;  // places in x
constexpr int kAngle = 1;
constexpr double kUprightWithin = 1e-9;  // [rad]

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

TrueStateObservation::TrueStateObservation(const Plant& plant, const PilcoOptions& options)
    : plant_(plant), options_(options) {
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
  return {{kAngle}, start, pilco::pendulumCost(/*length=*/1.0, options_.cost_width), length_scales};
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
  x[kRate] += options_.rate_noise * normal(noise_);
  x[kAngle] += options_.angle_noise * normal(noise_);
  return x;
}

PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                    const Eigen::VectorXd& goal, const PilcoOptions& options) {
  const Eigen::VectorXd std = pilco::sampleStd(X);
  const double spread = std.norm();
  if (!(spread > 0.0)) throw std::runtime_error("all images are observed as the same state");
  const int dim = static_cast<int>(X.rows());
  const double width = options.cost_width * spread;
  const Eigen::MatrixXd weight = Eigen::MatrixXd::Identity(dim, dim) / (width * width);
  return {{},
          startDistribution(X, segments, options.start_std * spread),
          pilco::StateCost(pilco::replaceAngles(dim, {}), pilco::SaturatingCost(goal, weight)),
          std};
}

FeatureObservation::FeatureObservation(const ModelConfig& model, const PilcoOptions& options)
    : ImageObservation(model, options) {
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
  task_ = imageTask(Z, data.segments(), model_->goalFeature(), options_);
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
  task_ = imageTask(Z, data.segments(), observe(data.goal()), options_);
  return Z;
}

}  // namespace ddm
