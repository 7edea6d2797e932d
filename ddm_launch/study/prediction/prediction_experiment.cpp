// prediction_experiment: measures how well a model predicts held-out images (paper, Sec. 4.1).
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/option_checks.h>
#include <ddm_common/param_value.h>
#include <ddm_model/ddm.h>
#include <ddm_model/minimise.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>
#include <ddm_sim/environment.h>
#include <ddm_sim/plant.h>

#include <Eigen/QR>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation.h"
#include "in_process_driver.h"
#include "method.h"
#include "progress.h"
#include "resolution.h"
#include "run_folder.h"
#include "tables.h"

namespace ddm {
namespace {

constexpr char kAbout[] =
    "Records one long random trial of 601 samples, trains on the first 501 and predicts the rest,\n"
    "1 to 8 steps ahead. Writes config.yaml, model.ddm, predictions.csv (errors by steps ahead),\n"
    "features.csv (of every image), strip.csv (one prediction, step by step) and, last,\n"
    "summary.yaml.\n\n"
    "usage: rosrun ddm_launch prediction_experiment --preset paper --plant moving_tile --seed 1\n"
    "                                               --out DIR";

constexpr int kTrainingSamples = 501;  // the paper has 601 samples in total
constexpr int kHeldOutSamples = 100;   // samples after the training samples, for the test
constexpr int kMaxSteps = 8;           // longest prediction [steps]

/// A random trial: training and held-out samples, and the true states.
struct Recording {
  DataSet training;
  DataSet held_out;
  Eigen::MatrixXd states;     ///< true states of all samples      [stateDim() x N]
  Eigen::MatrixXd positions;  ///< visiblePosition() of all samples   [. x N]
};

/// Records training and held-out samples in one trial with uniformly random torques, from a random
/// initial state.
Recording record(const Configuration& all) {
  Environment environment(makePlant(*all.plant), all.camera);
  const Plant& plant = environment.plant();
  TrialRequest request = requestFor(all, 0, /*evaluation=*/false);
  request.num_steps = kTrainingSamples + kHeldOutSamples;
  request.epsilon = 1.0;
  const DataSet none(all.model.image.size, plant.torqueDim());
  Recording out{none, none, Eigen::MatrixXd(plant.stateDim(), request.num_steps), {}};
  out.positions.resize(plant.visiblePosition(plant.state()).size(), request.num_steps);
  runClosedLoop(&environment, nullptr, request, all, [&](const ClosedLoopFrame& frame) {
    const bool learn = frame.index < kTrainingSamples;
    const bool first = frame.index == 0 || frame.index == kTrainingSamples;
    (learn ? out.training : out.held_out).append(frame.grey, frame.decision.torque, first);
    out.positions.col(frame.index) = plant.visiblePosition(plant.state());
    out.states.col(frame.index) = plant.state();
  });
  return out;
}

/// Monomials up to degree two of each sample: [1, x_i, x_i x_j (i <= j)].
Eigen::MatrixXd monomials(const Eigen::MatrixXd& x) {
  const Eigen::Index n = x.rows();
  Eigen::MatrixXd out(1 + n + n * (n + 1) / 2, x.cols());
  out.row(0).setOnes();
  out.middleRows(1, n) = x;
  Eigen::Index row = 1 + n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) out.row(row++) = x.row(i).cwiseProduct(x.row(j));
  }
  return out;
}

/// Measures how well the features determine the position of the moving part, up to a quadratic map.
/// The map is fitted to the training samples. The result is computed on the held-out samples; 1 is
/// perfect:
///
///   R^2 = 1 - sum |y - fit(x)|^2 / sum |y - mean(y)|^2
/// @param x  features of all samples, one per column
/// @param y  positions of all samples, one per column
double positionR2(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  const Eigen::MatrixXd coefficients = monomials(x.leftCols(kTrainingSamples))
                                           .transpose()
                                           .colPivHouseholderQr()
                                           .solve(y.leftCols(kTrainingSamples).transpose())
                                           .transpose();
  const Eigen::MatrixXd held_out = y.rightCols(kHeldOutSamples);
  const Eigen::MatrixXd spread = held_out.colwise() - held_out.rowwise().mean().eval();
  return 1.0 - (held_out - coefficients * monomials(x.rightCols(kHeldOutSamples))).squaredNorm() /
                   spread.squaredNorm();
}

std::string featuresCsv(const PlantInfo& plant, const Recording& recording,
                        const Eigen::MatrixXd& Z) {
  const auto feature_dim = static_cast<int>(Z.rows());
  std::string text = csvLine("frame", "set", plant.state_names, featureNames(feature_dim));
  for (Eigen::Index i = 0; i < Z.cols(); ++i) {
    const char* const set = i < recording.training.numFrames() ? "training" : "held_out";
    text += csvLine(i, set, recording.states.col(i), Z.col(i));
  }
  return text;
}

/// A rollout that starts in the middle of the held-out samples with a full history, as CSV.
std::string stripCsv(const PlantInfo& plant, const Recording& recording, const Ddm& model,
                     const Eigen::MatrixXd& Z) {
  const Eigen::Index memory = model.options().memory();
  const Eigen::Index frame = memory - 1 + (recording.held_out.numFrames() - kMaxSteps - memory) / 2;
  const Eigen::Index begin = recording.training.numFrames() + frame;
  const Eigen::MatrixXd predicted = model.rollOut(Z.rightCols(recording.held_out.numFrames()),
                                                  recording.held_out.torques(), frame, kMaxSteps);
  std::string text = csvLine("steps", plant.state_names, featureNames(model.featureDim()));
  for (int k = 0; k <= kMaxSteps; ++k) {
    text += csvLine(k, recording.states.col(begin + k), predicted.col(k));
  }
  return text;
}

std::string predictionsCsv(const std::vector<PredictionError>& errors, double position_r2,
                           const ModelInfo& info, double train_s) {
  std::string text = "seed,steps,num_predictions,rmse,rmse_repeat,position_r2,v_r,v_p,train_s\n";
  for (const PredictionError& error : errors) {
    text += csvLine(info.seed, error.steps, error.num_predictions, error.rmse, error.rmse_repeat,
                    position_r2, info.v_r, info.v_p, train_s);
  }
  return text;
}

void run(const Configuration& all) {
  RunFolder folder(all);
  for (const std::string& warning : folder.warnings()) std::cout << "warning: " << warning << "\n";
  const Recording recording = record(all);
  folder.begin();  // all checks have passed
  ModelInfo info;
  info.seed = static_cast<std::uint64_t>(all.experiment.seed);
  info.config = toText(all.model);
  Progress progress;
  progress.beginPhase(0, "train");
  const TrainingResult result = train(recording.training, all.model.model, all.model.training, info,
                                      [&progress](const TrainingProgress& state) {
                                        progress.update(state.fraction_done);
                                        return true;
                                      });
  if (!result.model) throw std::runtime_error(result.message);
  const Ddm& model = *result.model;

  Eigen::MatrixXd Z(model.featureDim(), kTrainingSamples + kHeldOutSamples);
  Z << encodeAll(model, recording.training), encodeAll(model, recording.held_out);
  const double position_r2 = positionR2(Z, recording.positions);
  const std::vector<PredictionError> errors =
      predictionErrors(model, recording.held_out, kMaxSteps);

  folder.write("model.ddm", serialiseModel(model));
  folder.write("features.csv", featuresCsv(all.plant_info, recording, Z));
  folder.write("strip.csv", stripCsv(all.plant_info, recording, model, Z));
  folder.write("predictions.csv",
               predictionsCsv(errors, position_r2, model.info(), result.seconds));
  YAML::Node summary(YAML::NodeType::Map);
  summary["plant"] = all.experiment.plant;
  summary["seed"] = all.experiment.seed;
  summary["schedule"] = all.model.training.schedule;
  summary["rmse"] = valueToYaml(errors.back().rmse);
  summary["rmse_repeat"] = valueToYaml(errors.back().rmse_repeat);
  summary["position_r2"] = valueToYaml(position_r2);
  summary["train_s"] = valueToYaml(result.seconds);
  folder.finish(summary);
  std::cout << YAML::Dump(summary) << "\nresults, up to " << kMaxSteps
            << " steps ahead: " << folder.path() << "\n";
}

/// @return false if the only option is --help, whose text has been printed
bool configure(int argc, char** argv, Configuration* all) {
  Arguments arguments;
  if (!parseCommandLine(argc, argv, commonOptions(kAbout, &arguments))) return false;
  ParamReader reader = resolve(arguments).reader();
  *all = readWithMethod(&reader);
  OptionChecks camera("camera"), names("experiment");
  camera.require(all->camera.drop_rate == 0.0, "drop_rate",
                 "be 0, since predictions go on from image to image", all->camera.drop_rate);
  names.require(all->experiment.method == "ddm", "method", "be ddm", all->experiment.method);
  camera.add(names.problems());
  requireNone(camera.problems());
  return true;
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  ddm::Configuration configuration;
  return ddm::runTool(
      "prediction_experiment", [&] { return ddm::configure(argc, argv, &configuration); },
      [&] { ddm::run(configuration); });
}
