// evaluate: how good is a saved model? Greedy runs on a plant, one for each seed, without a master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_files/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_model/solver_log.h>
#include <ddm_params/param_value.h>
#include <ddm_sim/plant_factory.h>
#include <ros/time.h>
#include <unistd.h>

#include <atomic>
#include <boost/filesystem.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "command_line.h"
#include "evaluation.h"
#include "in_process_driver.h"
#include "saved_model.h"

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
  std::string out;  ///< folder
  int first_seed = 0;
  int end_seed = 0;  ///< excluded
  int jobs = 1;
};

struct Row {
  int seed = 0;
  ddm::Evaluation evaluation;
  double plan_ms_median = 0.0;
  double plan_ms_p99 = 0.0;
};

/// "A:B", B excluded, as the seeds of a sweep.
void parseSeeds(const std::string& text, Request* request) {
  char rest = 0;
  const int num_read =
      std::sscanf(text.c_str(), "%d:%d%c", &request->first_seed, &request->end_seed, &rest);
  if (num_read != 2 || request->first_seed < 0 || request->end_seed <= request->first_seed) {
    throw po::error("--seeds must be A:B with 0 <= A < B (B is excluded), got '" + text + "'");
  }
}

/// @return false where --help was asked for and has been printed
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
  ddm::ParamReader reader = ddm::resolve(arguments).reader();
  *configuration = ddm::readWithMethod(&reader);
  return true;
}

Row evaluateSeed(ddm::Configuration configuration, int seed, std::uint32_t trial,
                 std::mutex* making) {
  ddm::TrialRequest request;
  request.id = {static_cast<std::uint64_t>(seed), trial, /*evaluation=*/true};
  request.num_steps = configuration.trial.num_steps;
  request.hold_steps = configuration.mpc.hold_steps;
  std::unique_ptr<ddm::InProcessDriver> driver;
  std::unique_ptr<ddm::Plant> plant;
  {
    const std::lock_guard<std::mutex> lock(
        *making);  // nobody promised that plants are made at once
    driver = std::make_unique<ddm::InProcessDriver>(configuration);
    plant = ddm::makePlant(*configuration.plant);
  }
  const ddm::TrialOutcome outcome = driver->runTrial(request, [](double) {});
  Row row;
  row.seed = seed;
  plant->setGoal(ddm::goalOf(*plant, request.id.seed, trial, /*evaluation=*/true));
  row.evaluation = ddm::evaluate(*plant, outcome.states, outcome.torques, configuration.evaluation);
  row.plan_ms_median = 1e3 * ddm::quantile(outcome.solve_times, 0.5);
  row.plan_ms_p99 = 1e3 * ddm::quantile(outcome.solve_times, 0.99);
  return row;
}

/// All seeds, several at a time. The first error ends it.
std::vector<Row> evaluateAll(const ddm::Configuration& configuration, const Request& request,
                             std::uint32_t trial) {
  std::vector<Row> rows(static_cast<size_t>(request.end_seed - request.first_seed));
  std::atomic<size_t> next{0};
  std::mutex mutex;
  std::string error;
  size_t num_done = 0;
  const bool live = ::isatty(STDERR_FILENO) != 0;
  const auto work = [&] {
    for (size_t i = next++; i < rows.size(); i = next++) {
      try {
        rows[i] =
            evaluateSeed(configuration, request.first_seed + static_cast<int>(i), trial, &mutex);
      } catch (const std::exception& e) {
        const std::lock_guard<std::mutex> lock(mutex);
        error = e.what();
        next = rows.size();
        return;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      ++num_done;
      if (live) std::cerr << "\r" << num_done << " of " << rows.size() << " runs" << std::flush;
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < request.jobs; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (live) std::cerr << "\n";
  if (!error.empty()) throw std::runtime_error(error);
  return rows;
}

/// Enough digits for a rate or a time.
double rounded(double value) { return std::round(1e4 * value) / 1e4; }

std::string csvOf(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "seed,success,success_strict,final_error,plan_ms_median,plan_ms_p99,return\n";
  for (const Row& row : rows) {
    const ddm::Evaluation& evaluation = row.evaluation;
    out << row.seed << "," << evaluation.success << "," << evaluation.success_strict << ","
        << ddm::formatDouble(evaluation.final_error.value()) << ","
        << ddm::formatDouble(rounded(row.plan_ms_median)) << ","
        << ddm::formatDouble(rounded(row.plan_ms_p99)) << ","
        << (evaluation.total_reward ? ddm::formatDouble(*evaluation.total_reward) : "") << "\n";
  }
  return out.str();
}

/// A rate with the interval that it does not speak against.
void addRate(const std::vector<Row>& rows, const std::string& name, bool ddm::Evaluation::*measure,
             YAML::Node* summary) {
  int successes = 0;
  for (const Row& row : rows) successes += row.evaluation.*measure ? 1 : 0;
  const auto n = static_cast<int>(rows.size());
  const auto interval = ddm::wilsonInterval(successes, n);
  (*summary)[name] = std::to_string(successes) + " of " + std::to_string(n);
  (*summary)[name + "_rate"] = ddm::valueToYaml(rounded(static_cast<double>(successes) / n));
  (*summary)[name + "_interval_95"] =
      ddm::valueToYaml(std::vector<double>{rounded(interval.first), rounded(interval.second)});
}

void run(const Request& request, ddm::Configuration configuration) {
  const std::shared_ptr<const ddm::Ddm> model = ddm::readModel(request.model);
  // What the model is, it says itself; how it is used, the configuration.
  configuration.model.image.size = model->imageSize();
  configuration.model.model = model->options();
  configuration.method = std::make_shared<ddm::SavedModelSetup>(model, request.model);
  const std::string& folder = request.out;
  std::cerr << "model " << request.model << " on " << configuration.experiment.plant
            << ", mpc of preset " << configuration.experiment.preset << "\n";
  const std::vector<Row> rows = evaluateAll(configuration, request, model->info().trial);
  YAML::Node summary(YAML::NodeType::Map);
  summary["model"] = request.model;
  summary["id"] = ddm::modelId(ddm::readFile(request.model));
  summary["plant"] = configuration.experiment.plant;
  summary["preset"] = configuration.experiment.preset;
  summary["seeds"] = std::to_string(request.first_seed) + ":" + std::to_string(request.end_seed);
  addRate(rows, "success", &ddm::Evaluation::success, &summary);
  addRate(rows, "success_strict", &ddm::Evaluation::success_strict, &summary);
  std::vector<double> errors, returns;
  for (const Row& row : rows) {
    errors.push_back(row.evaluation.final_error.value());
    if (row.evaluation.total_reward) returns.push_back(*row.evaluation.total_reward);
  }
  summary["error_unit"] = configuration.evaluation.error_unit;
  summary["final_error_median"] = ddm::valueToYaml(ddm::quantile(errors, 0.5));
  if (!returns.empty()) summary["return_median"] = ddm::valueToYaml(ddm::quantile(returns, 0.5));
  boost::filesystem::create_directories(boost::filesystem::absolute(folder));  // refuses a mere "."
  ddm::writeFileAtomically(folder + "/evaluation.csv", csvOf(rows));
  ddm::writeFileAtomically(folder + "/evaluation.yaml", YAML::Dump(summary) + "\n");
  std::cout << YAML::Dump(summary) << "\nrows: " << folder << "/evaluation.csv\n";
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
