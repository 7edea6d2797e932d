// evaluate: runs greedy evaluations of a saved model on a plant, one per seed, without a master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_model/minimise.h>
#include <ddm_model/model_file.h>
#include <ddm_sim/plant.h>
#include <ros/time.h>

#include <atomic>
#include <boost/filesystem.hpp>
#include <cmath>
#include <cstdio>
#include <future>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "evaluation.h"
#include "in_process_driver.h"
#include "method.h"
#include "resolution.h"
#include "start.h"
#include "tables.h"

namespace po = boost::program_options;

namespace {

constexpr char kAbout[] =
    "Scores a saved model: a greedy run on the plant for each seed, judged as in an experiment.\n"
    "Writes DIR/evaluation.csv, a row a seed, and DIR/evaluation.yaml. The run of a seed is the\n"
    "greedy evaluation of the experiment with that seed after the model's trial.\n\n"
    "usage: rosrun ddm_launch evaluate --model FILE --plant pendulum --seeds 0:20 [--preset P]\n"
    "                                  [--config FILE]... [--out DIR]";

struct Request {
  std::string model;
  std::string out;     ///< output folder
  int first_seed = 0;  ///< first seed
  int end_seed = 0;    ///< last seed + 1
  int jobs = 1;
};

/// Parses "A:B", the seeds A ... B - 1, as for a sweep.
void parseSeeds(const std::string& text, Request* request) {
  char rest = 0;
  const int num_read =
      std::sscanf(text.c_str(), "%d:%d%c", &request->first_seed, &request->end_seed, &rest);
  if (num_read != 2 || request->first_seed < 0 || request->end_seed <= request->first_seed) {
    throw po::error("--seeds must be A:B with 0 <= A < B (B is excluded), got '" + text + "'");
  }
}

/// @return false if --help was given and has been printed
bool configure(int argc, char** argv, Request* request, ddm::Configuration* configuration) {
  ddm::Arguments arguments;
  std::string seeds;
  const int num_cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  po::options_description options = ddm::configurationOptions(kAbout, &arguments);
  options.add_options()("model", po::value(&request->model)->required(), "model file");
  options.add_options()("seeds", po::value(&seeds)->required(), "A:B, B excluded");
  options.add_options()("jobs", po::value(&request->jobs)->default_value(num_cores),
                        "runs at a time");
  options.add_options()("out", po::value(&request->out)->default_value("."),
                        "folder of the results; made if need be");
  if (!ddm::parseCommandLine(argc, argv, options)) return false;
  parseSeeds(seeds, request);
  if (request->jobs < 1) {
    throw po::error("--jobs must be >= 1, got " + std::to_string(request->jobs));
  }
  // Only the method `ddm` acts with such a model.
  arguments.set("experiment/method", std::string("ddm"));
  ddm::ParamReader reader = ddm::resolve(arguments).reader();
  *configuration = ddm::readWithMethod(&reader);
  return true;
}

/// Runs the evaluation of one seed.
/// @param making  mutex held while a plant is made, because plugins need not support making several
///                plants at once
ddm::TrialRow evaluateSeed(ddm::Configuration configuration, const std::string& model, int seed,
                           int trial, std::mutex* making) {
  configuration.experiment.seed = seed;
  const ddm::TrialRequest request = ddm::requestFor(configuration, trial, /*evaluation=*/true);
  std::unique_lock<std::mutex> lock(*making);
  ddm::InProcessDriver driver(configuration);
  const std::unique_ptr<ddm::Plant> plant = ddm::makePlant(*configuration.plant);
  lock.unlock();
  driver.useModel(model);
  const ddm::TrialOutcome outcome = driver.runTrial(request, [](double) {});
  return ddm::rowOf(request.id, outcome, configuration.evaluation, plant.get());
}

/// Evaluates all seeds with several threads. Stops at the first error.
std::vector<ddm::TrialRow> evaluateAll(const ddm::Configuration& configuration,
                                       const Request& request, int trial) {
  std::vector<ddm::TrialRow> rows(static_cast<size_t>(request.end_seed - request.first_seed));
  std::atomic<int> next{request.first_seed};
  std::mutex making;
  const auto work = [&] {
    for (int seed = next++; seed < request.end_seed; seed = next++) {
      try {
        rows[static_cast<size_t>(seed - request.first_seed)] =
            evaluateSeed(configuration, request.model, seed, trial, &making);
      } catch (...) {
        next = request.end_seed;
        throw;
      }
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < request.jobs; ++i) workers.push_back(std::async(std::launch::async, work));
  for (std::future<void>& worker : workers) worker.get();
  return rows;
}

/// Rounds to four decimals, which suffice for a rate or a time.
double rounded(double value) { return std::round(1e4 * value) / 1e4; }

std::string csvOf(const std::vector<ddm::TrialRow>& rows) {
  std::string text = "seed,success,success_strict,final_error,plan_ms_median,plan_ms_p99,return\n";
  for (const ddm::TrialRow& row : rows) {
    text += ddm::csvLine(row.seed, row.evaluation.success, row.evaluation.success_strict,
                         row.evaluation.final_error, rounded(row.plan_ms_median),
                         rounded(row.plan_ms_p99), row.evaluation.total_reward);
  }
  return text;
}

/// Counts, rates with their intervals, and medians, as a YAML map. Texts are quoted, because YAML
/// 1.1 readers such as PyYAML would parse 20:40 and an id of digits as numbers.
std::string summaryOf(const std::vector<ddm::TrialRow>& rows, const Request& request,
                      const ddm::Configuration& configuration) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  const auto add = [&out](const std::string& key, const std::string& text) {
    out << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << text;
  };
  const auto add_numbers = [&out](const std::string& key, const auto& numbers) {
    out << YAML::Key << key << YAML::Value << ddm::valueToYaml(numbers);
  };
  const auto add_rate = [&](const std::string& name, bool ddm::Evaluation::*measure) {
    int successes = 0;
    for (const ddm::TrialRow& row : rows) successes += row.evaluation.*measure ? 1 : 0;
    const auto n = static_cast<int>(rows.size());
    const auto interval = ddm::wilsonInterval(successes, n);
    add(name, std::to_string(successes) + " of " + std::to_string(n));
    add_numbers(name + "_rate", rounded(static_cast<double>(successes) / n));
    add_numbers(name + "_interval_95",
                std::vector<double>{rounded(interval.first), rounded(interval.second)});
  };
  add("model", request.model);
  add("id", ddm::modelId(ddm::readFile(request.model)));
  add("plant", configuration.experiment.plant);
  add("preset", configuration.experiment.preset);
  add("seeds", std::to_string(request.first_seed) + ":" + std::to_string(request.end_seed));
  add_rate("success", &ddm::Evaluation::success);
  add_rate("success_strict", &ddm::Evaluation::success_strict);
  std::vector<double> errors, returns;
  for (const ddm::TrialRow& row : rows) {
    errors.push_back(row.evaluation.final_error.value());
    if (row.evaluation.total_reward) returns.push_back(*row.evaluation.total_reward);
  }
  add("error_unit", configuration.plant_info.error_unit);
  add_numbers("final_error_median", ddm::quantile(errors, 0.5));
  if (!returns.empty()) add_numbers("return_median", ddm::quantile(returns, 0.5));
  out << YAML::EndMap;
  return out.c_str();
}

void run(const Request& request, ddm::Configuration configuration) {
  const std::shared_ptr<const ddm::Ddm> model = ddm::readModel(request.model);
  // The model file defines the model. The configuration defines the controller and the plant.
  configuration.model.image.size = model->imageSize();
  configuration.model.model = model->options();
  std::cerr << "model " << request.model << " on " << configuration.experiment.plant
            << ", mpc of preset " << configuration.experiment.preset << "\n";
  ddm::requireModelFits(model, request.model, configuration);
  // create_directories() fails for the path "."
  boost::filesystem::create_directories(boost::filesystem::absolute(request.out));
  ddm::requireWritable(request.out + "/evaluation.csv");
  const std::vector<ddm::TrialRow> rows =
      evaluateAll(configuration, request, static_cast<int>(model->info().trial));
  const std::string summary = summaryOf(rows, request, configuration);
  ddm::writeFileAtomically(request.out + "/evaluation.csv", csvOf(rows));
  ddm::writeFileAtomically(request.out + "/evaluation.yaml", summary + "\n");
  std::cout << summary << "\nrows: " << request.out << "/evaluation.csv\n";
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  Request request;
  ddm::Configuration configuration;
  return ddm::runTool(
      "evaluate", [&] { return configure(argc, argv, &request, &configuration); },
      [&] { run(request, configuration); });
}
