// benchmark_kernels: computing times, by Google Benchmark, on a finished experiment, and round trips between nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>
#include <ddm_bag_io/bag_cache.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/tool.h>
#include <ddm_model/initialisation.h>
#include <ddm_model/model_file.h>
#include <ddm_model/networks.h>
#include <ddm_model/objective.h>
#include <ddm_model/schedule.h>
#include <ddm_model/solver_log.h>
#include <ddm_model/trainer.h>
#include <ddm_mpc/controller.h>
#include <ddm_mpc/ddm_plan_cost.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant_factory.h>
#include <ros/time.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "round_trips.h"
#include "run_folder.h"

namespace ddm {
namespace {

constexpr int kRetrainIterations = 200;
constexpr int kProductBlocks[] = {32, 64, 128, 256, 512, 1600};
constexpr int kTrialSteps = 100;

constexpr char kAbout[] =
    "Times objective, training, plans, renderer and bag reading on the bags and the last model of "
    "a finished experiment, and the images of further plants; or round trips of messages.\n\n"
    "usage: rosrun ddm_launch benchmark_kernels RUN_FOLDER [PLANT...] [options of Google "
    "Benchmark]\n"
    "       rosrun ddm_launch benchmark_kernels lockstep|bare_camera|bare_controller NUM_FRAMES\n\n"
    "`rosrun ddm_launch qa benchmark` runs both.";

/// What a finished experiment has left behind.
struct Experience {
  Configuration configuration;
  std::vector<std::string> bags;
  DataSet data;
  std::shared_ptr<const Ddm> model;
};

Experience readExperience(const std::string& run) {
  ParamReader reader = ParamReader::fromFiles({run + "/config.yaml"});
  Configuration configuration = readConfiguration(&reader);
  configuration.experiment.runs = run;
  const RunFolder folder(configuration);
  if (folder.rows().empty()) throw std::runtime_error(run + " holds no finished trial");
  std::vector<std::string> bags;
  for (const TrialRow& row : folder.rows()) {
    for (int episode = 0; episode < configuration.trial.episodes; ++episode) {
      bags.push_back(folder.bagPath(row.trial, episode));
    }
  }
  const std::string model = folder.modelPath(folder.rows().back().trial);
  DataSet data = BagCache(configuration.model.image.size, configuration.model.data_set).read(bags);
  return {configuration, bags, std::move(data),
          std::make_shared<const Ddm>(deserialiseModel(readFile(model), model))};
}

double percentile99(const std::vector<double>& values) { return quantile(values, 0.99); }

/// Each repetition is one call: their quantiles are those of single calls.
void measure(const std::string& name, int num_calls, const std::function<void()>& call) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [call](benchmark::State& state) {
                                 for (auto _ : state) call();
                               })
      ->Iterations(1)
      ->Repetitions(num_calls)
      ->ReportAggregatesOnly(true)
      ->ComputeStatistics("p99", percentile99)
      ->Unit(benchmark::kMicrosecond);
}

/// W a, delta a^T and W^T delta of each layer of g^-1, g and f, on random matrices: what no
/// implementation of an objective with its gradient leaves out, and nothing else. f predicts
/// num_steps features from each image, and the decoder has those and the image's own.
class MatrixProducts {
 public:
  /// @param block  so many of the samples go through all networks before the next ones do
  MatrixProducts(const Networks<float>& networks, Eigen::Index num_samples, int num_steps,
                 Eigen::Index block)
      : num_blocks_((num_samples + block - 1) / block) {
    add(networks.encoder(), block, false);  // nothing is learned before the images
    add(networks.f(), num_steps * block, true);
    add(networks.decoder(), (1 + num_steps) * block, true);
  }

  void run() {
    for (Eigen::Index block = 0; block < num_blocks_; ++block) {
      for (Layer& layer : layers_) layer.outputs.noalias() = layer.weights * layer.inputs;
      for (Layer& layer : layers_) {
        layer.d_weights.noalias() += layer.d_outputs * layer.inputs.transpose();
        if (!layer.needs_d_inputs) continue;
        layer.d_inputs.noalias() = layer.weights.transpose() * layer.d_outputs;
      }
    }
  }

 private:
  struct Layer {
    Eigen::MatrixXf weights, d_weights;  // [outputs x inputs]
    Eigen::MatrixXf inputs, d_inputs;    // [inputs x samples]
    Eigen::MatrixXf outputs, d_outputs;  // [outputs x samples]
    bool needs_d_inputs = true;
  };

  void add(const Mlp<float>& net, Eigen::Index samples, bool needs_d_inputs) {
    for (size_t l = 1; l < net.widths().size(); ++l) {
      const int inputs = net.widths()[l - 1], outputs = net.widths()[l];
      Layer layer;
      layer.weights = layer.d_weights = Eigen::MatrixXf::Random(outputs, inputs);
      layer.inputs = layer.d_inputs = Eigen::MatrixXf::Random(inputs, samples);
      layer.outputs = layer.d_outputs = Eigen::MatrixXf::Random(outputs, samples);
      layer.needs_d_inputs = needs_d_inputs || l > 1;
      layers_.push_back(std::move(layer));
    }
  }

  Eigen::Index num_blocks_;
  std::vector<Layer> layers_;
};

void measureObjective(const Experience& experience) {
  const auto networks = std::make_shared<const Networks<float>>(experience.model->options(),
                                                                experience.data.torqueDim());
  const auto objective = std::make_shared<JointObjective<float>>(
      *networks, makeTrainingData(experience.data, experience.model->pca()));
  const Eigen::VectorXf theta = experience.model->theta().cast<float>();
  const auto d_theta = std::make_shared<Eigen::VectorXf>();
  const Terms terms = makeSchedule(experience.configuration.model.training).terms();
  measure("objective_gradient", 1000, [networks, objective, theta, d_theta, terms]() {
    benchmark::DoNotOptimize(objective->evaluate(theta, d_theta.get(), terms));
  });
  for (const int block : kProductBlocks) {
    const auto products = std::make_shared<MatrixProducts>(*networks, objective->numPredictions(),
                                                           terms.prediction_steps, block);
    measure("matrix_products/" + std::to_string(block), 1000, [products]() { products->run(); });
  }
}

void measureTraining(const Experience& experience) {
  const ModelConfig& config = experience.configuration.model;
  measure("pca", 30, [&experience, &config]() {
    benchmark::DoNotOptimize(fitPca(experience.data, config.model.pca_dim,
                                    Blur(experience.data.imageSize(), config.model.blur))
                                 .scale);
  });
  TrainingOptions training = config.training;
  training.max_iterations = kRetrainIterations;
  training.function_tolerance = 1e-30;  // so many iterations, whatever they are good for
  measure("retrain", 10, [&experience, &config, training]() {
    const TrainingResult result = train(experience.data, config.model, training, ModelInfo());
    if (result.iterations < kRetrainIterations * training.num_starts) {
      throw std::runtime_error("training ended after " + std::to_string(result.iterations) +
                               " iterations: " + result.message);
    }
  });
}

/// Greedy trials on the true plant, one plan after the other.
class PlanSequence {
 public:
  PlanSequence(const Experience& experience, const MpcOptions& mpc)
      : plant_(makePlant(*experience.configuration.plant)), policy_(experience.model, mpc) {}

  Plan next() {
    if (step_++ % kTrialSteps == 0) {
      id_.evaluation = true;
      ++id_.trial;
      std::mt19937_64 start = startStream(id_.seed, id_.trial, id_.evaluation);
      plant_->setState(plant_->drawStart(start));
      policy_.startTrial(id_);
    }
    policy_.observe(plant_->render(plant_->state()).bytes);
    const Plan plan = policy_.plan();
    const Eigen::VectorXd torque = plan.torques.col(0);
    policy_.apply(torque);
    plant_->step(torque);
    return plan;
  }

 private:
  std::unique_ptr<Plant> plant_;
  MpcPolicy policy_;
  TrialId id_;
  int step_ = 0;
};

/// Decisions along greedy trials, one after the other; with a period, about images that come at this
/// rate, where no search for a plan may end before its budget.
void measurePlans(const std::string& name, const Experience& experience, const MpcOptions& mpc,
                  int num_plans, std::chrono::steady_clock::duration period) {
  using Clock = std::chrono::steady_clock;
  const auto sequence = std::make_shared<PlanSequence>(experience, mpc);
  const auto due = std::make_shared<Clock::time_point>(Clock::now());
  benchmark::RegisterBenchmark(
      name.c_str(),
      [sequence, due, period](benchmark::State& state) {
        for (auto _ : state) {
          *due = std::max(*due + period, Clock::now());
          std::this_thread::sleep_until(*due);
          const Plan plan = sequence->next();
          const std::chrono::duration<double> time = Clock::now() - *due;
          const bool has_budget = period.count() > 0;
          state.SetIterationTime(has_budget ? time.count() : plan.solve_time);
          state.counters["plan_iterations"] = plan.iterations;
          if (has_budget && plan.status != PlanStatus::kTimeLimit) {
            state.SkipWithError("a plan has ended before mpc/time_budget");
          }
        }
      })
      ->Iterations(1)
      ->Repetitions(num_plans)
      ->UseManualTime()
      ->ReportAggregatesOnly(true)
      ->ComputeStatistics("p99", percentile99)
      ->Unit(benchmark::kMicrosecond);
}

void measurePlanning(const Experience& experience) {
  const Ddm& model = *experience.model;
  const MpcOptions& mpc = experience.configuration.mpc;
  measurePlans("plan", experience, mpc, 2000, std::chrono::seconds(0));

  MpcOptions endless = mpc;  // as many starts as are allowed, and none of them converges
  endless.num_starts = 1000;
  endless.max_iterations = 1000000;
  endless.function_tolerance = 0.0;
  endless.time_budget = 0.005;
  measurePlans("plan_5_ms", experience, endless, 500, std::chrono::milliseconds(10));

  const auto cost = std::make_shared<DdmPlanCost>(model, mpc.horizon, mpc.control_weight);
  History x(model.options().memory(), model.featureDim(), model.torqueDim());
  x.observe(model.encode(experience.data.image(0)));
  cost->setProblem(x, model.goalFeature());
  const Eigen::MatrixXd U = Eigen::MatrixXd::Constant(model.torqueDim(), mpc.horizon, 0.5);
  const auto d_U = std::make_shared<Eigen::MatrixXd>();
  measure("plan_cost_gradient", 1000,
          [cost, U, d_U]() { benchmark::DoNotOptimize(cost->evaluate(U, d_U.get())); });
}

void measureImages(const Experience& experience, const std::vector<std::string>& plants) {
  const Configuration& all = experience.configuration;
  measure("encode", 1000, [&experience]() {
    benchmark::DoNotOptimize(experience.model->encode(experience.data.image(0)));
  });
  const std::shared_ptr<Plant> plant = makePlant(*all.plant);
  measure("render", 1000, [plant]() { benchmark::DoNotOptimize(plant->render(plant->state())); });
  measure("read_bag", 50, [&experience, &all]() {
    benchmark::DoNotOptimize(
        readBag(experience.bags.front(), all.model.image.size, all.model.data_set)
            .data.numFrames());
  });
  for (const std::string& name : plants) {
    ParamReader reader = ParamReader::fromFiles({plantFile(name)});
    const auto maker = readPlant(&reader);
    reader.requireValid();
    const std::shared_ptr<Plant> other = makePlant(*maker);
    const auto rng = std::make_shared<std::mt19937_64>(0);
    measure("render/" + name, 200,
            [other, rng]() { benchmark::DoNotOptimize(other->render(other->drawStart(*rng))); });
    if (!other->viewModel()) continue;
    measure("view/" + name, 200,
            [other, rng]() { benchmark::DoNotOptimize(other->view(other->drawStart(*rng))); });
  }
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  if (argc < 2 || argv[1][0] == '-') {
    std::cout << ddm::kAbout << "\n";
    return argc < 2 ? ddm::kUsageError : EXIT_SUCCESS;
  }
  try {
    if (ddm::timesRoundTrips(argc, argv)) return EXIT_SUCCESS;
    const ddm::Experience experience = ddm::readExperience(argv[1]);
    int num_words = 2;
    while (num_words < argc && argv[num_words][0] != '-') ++num_words;
    ddm::measureObjective(experience);
    ddm::measureTraining(experience);
    ddm::measurePlanning(experience);
    ddm::measureImages(experience, {argv + 2, argv + num_words});
    char** options = argv + num_words - 1;
    options[0] = argv[0];
    int num_options = argc - num_words + 1;
    benchmark::Initialize(&num_options, options);
    if (benchmark::ReportUnrecognizedArguments(num_options, options)) return ddm::kUsageError;
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << "benchmark_kernels: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
