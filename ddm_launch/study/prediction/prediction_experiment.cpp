// prediction_experiment: how well a model predicts frames that it was not trained on (Sec. 4.1).
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/option_checks.h>
#include <ddm_common/param_value.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/solver_log.h>
#include <ddm_model/trainer.h>
#include <ddm_sim/environment.h>
#include <ddm_sim/plant_factory.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "closed_loop.h"
#include "csv_text.h"
#include "method_kinds.h"
#include "prediction_options.h"
#include "progress.h"
#include "quadratic_fit.h"
#include "resolution.h"
#include "results_folder.h"
#include "resumption.h"

namespace ddm {
namespace {

constexpr char kAbout[] =
    "Records one long random trial, trains on its first frames and predicts the rest, 1 step "
    "ahead\n"
    "and more. Writes config.yaml, model.ddm, predictions.csv (errors by steps ahead), "
    "features.csv\n"
    "(of every frame), strip.csv (one prediction, step by step) and, last, summary.yaml.\n\n"
    "usage: rosrun ddm_launch prediction_experiment --preset paper --plant moving_tile --seed 1\n"
    "                                               --out DIR";

/// A random trial: what a learner sees, and the true states behind it.
struct Recording {
  DataSet training;
  DataSet held_out;
  Eigen::MatrixXd states;     ///< of all frames            [stateDim() x N]
  Eigen::MatrixXd positions;  ///< visiblePosition() of all  [. x N]
};

struct Experiment {
  Configuration configuration;
  PredictionOptions prediction;
};

/// Training and held-out frames in one go: uniformly random torques from a random start.
Recording record(const Experiment& experiment, Environment* environment) {
  const Configuration& all = experiment.configuration;
  const Plant& plant = environment->plant();
  const int num_training = experiment.prediction.training_frames;
  TrialRequest request = requestFor(all, 0, /*evaluation=*/false);
  request.num_steps = num_training + experiment.prediction.held_out_frames;
  request.epsilon = 1.0;
  const DataSet none(all.model.image.size, plant.torqueDim());
  Recording out{none, none, Eigen::MatrixXd(plant.stateDim(), request.num_steps), {}};
  out.positions.resize(plant.visiblePosition(plant.state()).size(), request.num_steps);
  runClosedLoop(environment, nullptr, request, all, [&](const ClosedLoopFrame& frame) {
    const bool learn = frame.index < num_training;
    const bool first = frame.index == 0 || frame.index == num_training;
    (learn ? out.training : out.held_out).append(frame.grey, frame.decision.torque, first);
    out.positions.col(frame.index) = plant.visiblePosition(plant.state());
    out.states.col(frame.index) = plant.state();
  });
  return out;
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

/// The prediction from the middle of the held-out frames, of those that have a full history.
std::string stripCsv(const PlantInfo& plant, const Recording& recording, const Ddm& model,
                     const Eigen::MatrixXd& Z, int max_steps) {
  const Eigen::Index memory = model.options().memory();
  const Eigen::Index frame = memory - 1 + (recording.held_out.numFrames() - max_steps - memory) / 2;
  const Eigen::Index begin = recording.training.numFrames() + frame;
  const Eigen::MatrixXd predicted = model.rollOut(Z.rightCols(recording.held_out.numFrames()),
                                                  recording.held_out.torques(), frame, max_steps);
  std::string text = csvLine("steps", plant.state_names, featureNames(model.featureDim()));
  for (int k = 0; k <= max_steps; ++k) {
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

void run(const Experiment& experiment) {
  const Configuration& all = experiment.configuration;
  YAML::Node saved = toYaml(all);
  saved["prediction"] = toYaml(experiment.prediction);
  ResultsFolder folder(all.experiment.runs, saved);
  for (const std::string& warning : folder.warnings()) std::cout << "warning: " << warning << "\n";

  Environment environment(makePlant(*all.plant), all.camera);
  const Recording recording = record(experiment, &environment);
  folder.begin();  // nothing is left that could refuse
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

  const int max_steps = experiment.prediction.max_steps;
  const Eigen::Index num_training = recording.training.numFrames();
  const Eigen::Index num_held_out = recording.held_out.numFrames();
  Eigen::MatrixXd Z(model.featureDim(), num_training + num_held_out);
  Z << encodeAll(model, recording.training), encodeAll(model, recording.held_out);
  const QuadraticFit fit(Z.leftCols(num_training), recording.positions.leftCols(num_training));
  const double position_r2 =
      fit.explained(Z.rightCols(num_held_out), recording.positions.rightCols(num_held_out));
  const std::vector<PredictionError> errors =
      predictionErrors(model, recording.held_out, max_steps);

  folder.write("model.ddm", serialiseModel(model));
  folder.write("features.csv", featuresCsv(all.plant_info, recording, Z));
  folder.write("strip.csv", stripCsv(all.plant_info, recording, model, Z, max_steps));
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
  std::cout << YAML::Dump(summary) << "\nresults, up to " << max_steps
            << " steps ahead: " << folder.path() << "\n";
}

/// What no block can see by itself.
void requireFit(const Experiment& experiment) {
  const Configuration& all = experiment.configuration;
  const PredictionOptions& prediction = experiment.prediction;
  const ModelOptions& model = all.model.model;
  const int memory = model.order + largestDelay(model, all.model.training);
  OptionChecks checks("prediction");
  checks.require(prediction.held_out_frames >= prediction.max_steps + memory, "held_out_frames",
                 "be at least prediction/max_steps + model/order + the delay = " +
                     std::to_string(prediction.max_steps + memory),
                 prediction.held_out_frames);
  checks.require(prediction.training_frames > std::max(model.pca_dim, memory), "training_frames",
                 "be more than model/pca_dim, and model/order + the delay",
                 prediction.training_frames);
  OptionChecks camera("camera");
  camera.require(all.camera.drop_rate == 0.0, "drop_rate",
                 "be 0, since predictions go on from frame to frame", all.camera.drop_rate);
  checks.add(camera.problems());
  OptionChecks names("experiment");
  names.require(all.experiment.method == "ddm", "method", "be ddm", all.experiment.method);
  checks.add(names.problems());
  requireNone(checks.problems());
}

/// @return false where --help was asked for and has been printed
bool configure(int argc, char** argv, Experiment* experiment) {
  Arguments arguments;
  if (!parseCommandLine(argc, argv, commonOptions(kAbout, &arguments))) return false;
  ParamReader reader = resolve(arguments).reader();
  experiment->prediction = reader.read<PredictionOptions>("prediction");
  experiment->configuration = readWithMethod(&reader);
  requireFit(*experiment);
  return true;
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  ddm::Experiment experiment;
  return ddm::runTool(
      "prediction_experiment", [&] { return ddm::configure(argc, argv, &experiment); },
      [&] { ddm::run(experiment); });
}
