// PILCO's observation of the true state: angle and rate, measured with noise.
// SPDX-License-Identifier: BSD-3-Clause
#include "true_state_observation.h"

#include <ddm_model/plain_file.h>
#include <ddm_mpc/random_stream.h>

#include <boost/filesystem.hpp>
#include <stdexcept>

#include "trajectory_csv.h"

namespace ddm {
namespace {

constexpr int kRate = 0;  // places in x
constexpr int kAngle = 1;

/// (angle, rate) of the plant to x.
Eigen::VectorXd reorder(const Eigen::VectorXd& state) { return state.reverse(); }

}  // namespace

TrueStateObservation::TrueStateObservation(const Plant& plant, const PlantOptions& plant_options,
                                           const PilcoOptions& options)
    : plant_(plant), plant_options_(plant_options), options_(options), start_(plant.state()) {
  if (!plant.turns() || plant.stateDim() != 2) {
    throw std::invalid_argument(
        "PILCO on the true state knows a pendulum with angle and rate: use another plant or "
        "method, got plant/type " +
        plant_options.type);
  }
}

std::vector<std::string> TrueStateObservation::names() const {
  const std::vector<std::string> of_plant = plant_.stateNames();
  return {of_plant[1], of_plant[0]};
}

Eigen::MatrixXd TrueStateObservation::learn(const std::vector<std::string>& bags,
                                            const DataSet& data, const TrialId& id) {
  Eigen::MatrixXd X(2, data.numFrames());
  Eigen::Index frame = 0;
  for (size_t trial = 0; trial < bags.size(); ++trial) {
    const std::string file =
        (boost::filesystem::path(bags[trial]).parent_path() / "trajectory.csv").string();
    const Eigen::MatrixXd states = parseTrajectoryCsv(readFile(file), plant_.stateNames(), file);
    const Eigen::Index due = trial < data.pieces().size() ? data.pieces()[trial].size : 0;
    if (states.cols() != due) {
      throw std::runtime_error(
          file + " must have the " + std::to_string(due) + " frames of the bag beside it, got " +
          std::to_string(states.cols()) + ": the run folder is damaged, use another");
    }
    startTrial({id.seed, static_cast<std::uint32_t>(trial), false});
    for (Eigen::Index i = 0; i < states.cols(); ++i) X.col(frame++) = measure(states.col(i));
  }
  return X;
}

PilcoTask TrueStateObservation::task() const {
  const double variance = plant_options_.start_std * plant_options_.start_std;
  const pilco::Gaussian start{reorder(start_), variance * Eigen::MatrixXd::Identity(2, 2)};
  Eigen::VectorXd length_scales(3);  // of rate, sine, cosine, as in the published runs
  length_scales << 1.0, 0.7, 0.7;
  return {{kAngle},
          start,
          pilco::pendulumCost(plant_options_.length, options_.cost_width * plant_options_.length),
          length_scales};
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

}  // namespace ddm
