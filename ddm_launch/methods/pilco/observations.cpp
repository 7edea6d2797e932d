// Observations, the states of PILCO: true state, features of images, or principal components.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/plain_file.h>
#include <ddm_model/ddm.h>
#include <ddm_model/model_file.h>
#include <ddm_model/pca.h>
#include <ddm_model/trainer.h>
#include <ddm_sim/plant.h>

#include <boost/filesystem.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "pilco/gp.h"
#include "pilco/pilco_method.h"
#include "tables.h"

namespace ddm {
namespace {

constexpr char kModelFile[] = "model.ddm";
constexpr int kRate = 0;                 // index of the rate in x
constexpr int kAngle = 1;                // index of the angle in x
constexpr double kUprightWithin = 1e-9;  // [rad]
// Values of the published experiments.
constexpr double kCostWidth = 0.5;    // width of the saturating cost around the goal [spread]
constexpr double kRateNoise = 0.1;    // true state: standard deviation of measured rates [rad/s]
constexpr double kAngleNoise = 0.01;  // true state: standard deviation of measured angles [rad]
constexpr double kStartStd = 0.1;     // images: standard deviation of the initial state [spread]

/// Converts the state (angle, rate) of the plant to x = (rate, angle).
Eigen::VectorXd reorder(const Eigen::VectorXd& state) { return state.reverse(); }

/// Whether the plant is one rotary joint with state (angle, rate) and upright goal, as the cost
/// needs.
bool isPendulum(const Plant& plant) {
  const PlantInfo& info = plant.info();
  return info.joints.size() == 1 && info.joints[0].kind == JointKind::kAngle &&
         info.stateDim() == 2 &&
         std::abs(std::remainder(info.goal[0] - kPi, 2.0 * kPi)) <= kUprightWithin;
}

class TrueStateObservation : public Observation {
 public:
  explicit TrueStateObservation(const Plant& plant) : plant_(plant) {
    pilco::require(
        isPendulum(plant),
        "PILCO on the true state is for one joint with angle and rate whose goal is the angle pi; "
        "this plant has ",
        plant.info().joints.size(), " joint(s), ", plant.stateDim(),
        " state component(s) and the goal [", plant.info().goal.transpose(),
        "]: use method pilco_features or pilco_pca");
  }

  std::vector<std::string> names() const override {
    const std::vector<std::string>& of_plant = plant_.info().state_names;
    return {of_plant[1], of_plant[0]};
  }

  ObservedData learn(const std::vector<std::string>& bags, const DataSet& data,
                     const TrialId& id) override {
    Eigen::MatrixXd X(2, data.numFrames());
    Eigen::Index sample = 0;
    for (size_t trial = 0; trial < bags.size(); ++trial) {
      const std::string file =
          (boost::filesystem::path(bags[trial]).parent_path() / "trajectory.csv").string();
      const Eigen::MatrixXd states =
          parseTrajectoryCsv(readFile(file), plant_.info().state_names, file);
      const Eigen::Index due = trial < data.segments().size() ? data.segments()[trial].size : 0;
      if (states.cols() != due) {
        throw std::runtime_error(textOf(file, " must have the ", due,
                                        " frames of the bag beside it, got ", states.cols(),
                                        ": the run folder is damaged, use another"));
      }
      startTrial({id.seed, static_cast<std::uint32_t>(trial), false});
      for (Eigen::Index i = 0; i < states.cols(); ++i) X.col(sample++) = measure(states.col(i));
    }
    return {X, task()};
  }

  bool keepsCoordinates() const override { return true; }
  void startTrial(const TrialId& id) override {
    noise_ = randomStream(id, StreamRole::kMeasurement);
  }
  Eigen::VectorXd observe(const Image& /*image*/) override { return measure(plant_.state()); }

 private:
  PilcoTask task() const {
    const Eigen::VectorXd variance = reorder(plant_.info().start_std).cwiseAbs2();
    const pilco::Gaussian start{reorder(plant_.info().start), variance.asDiagonal()};
    Eigen::VectorXd length_scales(3);  // of rate, sine and cosine, as in the published experiments
    length_scales << 1.0, 0.7, 0.7;
    // Distance and width are in units of the rod's length, so that the length itself is not needed.
    return {{kAngle}, true, start, pilco::pendulumCost(/*length=*/1.0, kCostWidth), length_scales};
  }

  Eigen::VectorXd measure(const Eigen::VectorXd& state) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd x = reorder(state);
    x[kRate] += kRateNoise * normal(noise_);
    x[kAngle] += kAngleNoise * normal(noise_);
    return x;
  }

  const Plant& plant_;
  std::mt19937_64 noise_;
};

class FeatureObservation : public Observation {
 public:
  explicit FeatureObservation(const ModelConfig& model) : config_(model) {
    pilco::require(config_.training.schedule == "v_r_only",
                   "training/schedule must be v_r_only where PILCO learns the dynamics, got ",
                   config_.training.schedule);
  }

  std::vector<std::string> names() const override {
    return featureNames(config_.model.feature_dim);
  }

  ObservedData learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                     const TrialId& id) override {
    ModelInfo info;
    info.seed = id.seed;
    info.trial = id.trial;
    info.config = toText(config_);
    const TrainingResult result = train(data, config_.model, config_.training, info);
    if (!result.model) throw std::runtime_error("auto-encoder: " + result.message);
    model_ = *result.model;
    return observeAll(data);
  }

  ObservedData resume(const std::string& folder, const std::vector<std::string>& /*bags*/,
                      const DataSet& data, const TrialId& /*id*/) override {
    const std::string file = folder + "/" + kModelFile;
    model_ = deserialiseModel(readFile(file), file);
    return observeAll(data);
  }

  std::map<std::string, std::string> files() const override {
    return {{kModelFile, serialiseModel(*model_)}};
  }
  Eigen::VectorXd observe(const Image& image) override { return model_->encode(image); }

 private:
  ObservedData observeAll(const DataSet& data) const {
    const Eigen::MatrixXd Z = encodeAll(*model_, data);
    return {Z, imageTask(Z, data.segments(), model_->goalFeature())};
  }

  ModelConfig config_;
  std::optional<Ddm> model_;
};

class PcaObservation : public Observation {
 public:
  explicit PcaObservation(const ModelOptions& options) : options_(options) {}

  std::vector<std::string> names() const override { return featureNames(options_.pca_dim); }

  ObservedData learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                     const TrialId& /*id*/) override {
    if (!data.hasGoal()) {
      throw std::runtime_error(
          "the bags hold no goal image, which tells the goal: record one on goal_image");
    }
    const Pca pca = fitPca(data, options_.pca_dim, Blur(data.imageSize(), options_.blur),
                           options_.normalise_brightness);
    projection_ = Projection(pca);
    const Eigen::MatrixXd Z = pca.project(data).leftCols(data.numFrames()).cast<double>();
    return {Z, imageTask(Z, data.segments(), observe(data.goal()))};
  }
  Eigen::VectorXd observe(const Image& image) override { return projection_(image); }

 private:
  ModelOptions options_;
  Projection projection_;
};

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

std::unique_ptr<Observation> observeTrueState(const Configuration& /*all*/, const Plant& plant) {
  return std::make_unique<TrueStateObservation>(plant);
}
std::unique_ptr<Observation> observeFeatures(const Configuration& all, const Plant& /*plant*/) {
  return std::make_unique<FeatureObservation>(all.model);
}
std::unique_ptr<Observation> observePrincipalComponents(const Configuration& all,
                                                        const Plant& /*plant*/) {
  return std::make_unique<PcaObservation>(all.model.model);
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
          pilco::StateCost(pilco::replaceAngles(dim, {}), goal, weight),
          std};
}

}  // namespace ddm
