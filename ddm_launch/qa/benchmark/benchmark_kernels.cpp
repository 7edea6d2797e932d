// benchmark_kernels: measures computing times on a finished experiment, and message round trips.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>
#include <ddm_bag_io/bag_cache.h>
#include <ddm_common/tool.h>
#include <ddm_model/minimise.h>
#include <ddm_model/networks.h>
#include <ddm_model/objective.h>
#include <ddm_model/schedule.h>
#include <ddm_model/trainer.h>
#include <ddm_mpc/controller.h>
#include <ddm_sim/plant.h>
#include <ros/time.h>

#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "run_folder.h"
#include "start.h"

namespace ddm {

bool timesRoundTrips(int argc, char** argv);  // defined in round_trips.cpp

namespace {

constexpr int kRetrainIterations = 200;
constexpr int kProductBlocks[] = {32, 64, 128, 256, 512, 1600};
constexpr int kTrialSteps = 100;

constexpr char kAbout[] =
    "Times objective, training and plans on the bags and the last model of a finished experiment; "
    "or "
    "round trips of messages.\n\n"
    "usage: rosrun ddm_launch benchmark_kernels RUN_FOLDER [options of Google Benchmark]\n"
    "       rosrun ddm_launch benchmark_kernels lockstep|bare_camera|bare_controller NUM_FRAMES\n\n"
    "`rosrun ddm_launch qa benchmark` runs both.";

/// Results of a finished experiment: its configuration, all samples, and its last model.
struct Experience {
  Configuration configuration;
  DataSet data;
  std::shared_ptr<const Ddm> model;
};

Experience readExperience(const std::string& run) {
  ParamReader reader = ParamReader::fromFiles({run + "/config.yaml"});
  Configuration configuration = readConfiguration(&reader);
  configuration.experiment.runs = run;
  const RunFolder folder(configuration);
  if (folder.rows().empty()) throw std::runtime_error(run + " holds no finished trial");
  const int last = folder.rows().back().trial;
  DataSet data = BagCache(configuration.model.image.size, configuration.model.data_set)
                     .read(folder.bagsUpTo(last));
  return {configuration, std::move(data), readModel(folder.modelPath(last))};
}

double percentile99(const std::vector<double>& values) { return quantile(values, 0.99); }

/// Registers a benchmark. Each repetition has one call, so that quantiles over repetitions are
/// those of single calls.
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

/// The matrix products W a, delta a^T and W^T delta of each layer of g^-1, g and f, with random
/// matrices. Every implementation of V_R + V_P and its gradient needs these products, so their time
/// is a lower bound. f predicts num_steps features from each image, and the decoder decodes these
/// features and that of the image.
class MatrixProducts {
 public:
  /// @param block  number of samples that go through all networks together
  MatrixProducts(const Networks<float>& networks, Eigen::Index num_samples, int num_steps,
                 Eigen::Index block)
      : num_blocks_((num_samples + block - 1) / block) {
    add(networks.encoder(), block, false);  // the encoder's inputs need no gradient
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
  TrainingOptions training = config.training;
  training.max_iterations = kRetrainIterations;
  training.function_tolerance = 1e-30;  // always run all iterations
  measure("retrain", 10, [&experience, &config, training]() {
    const TrainingResult result = train(experience.data, config.model, training, ModelInfo());
    if (result.iterations < kRetrainIterations * training.num_starts) {
      throw std::runtime_error("training ended after " + std::to_string(result.iterations) +
                               " iterations: " + result.message);
    }
  });
}

/// Plans of evaluations on the true plant. The first torque of each plan moves the plant before the
/// next plan.
class PlanSequence {
 public:
  explicit PlanSequence(const Experience& experience)
      : plant_(makePlant(*experience.configuration.plant)),
        policy_(experience.model, experience.configuration.mpc) {}

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

/// Measures the time of plans along evaluations.
void measurePlans(const Experience& experience) {
  const auto sequence = std::make_shared<PlanSequence>(experience);
  benchmark::RegisterBenchmark("plan",
                               [sequence](benchmark::State& state) {
                                 for (auto _ : state) {
                                   const Plan plan = sequence->next();
                                   state.SetIterationTime(plan.solve_time);
                                   state.counters["plan_iterations"] = plan.iterations;
                                 }
                               })
      ->Iterations(1)
      ->Repetitions(2000)
      ->UseManualTime()
      ->ReportAggregatesOnly(true)
      ->ComputeStatistics("p99", percentile99)
      ->Unit(benchmark::kMicrosecond);
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
    ddm::measureObjective(experience);
    ddm::measureTraining(experience);
    ddm::measurePlans(experience);
    argv[1] = argv[0];
    int num_options = argc - 1;
    benchmark::Initialize(&num_options, argv + 1);
    if (benchmark::ReportUnrecognizedArguments(num_options, argv + 1)) return ddm::kUsageError;
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << "benchmark_kernels: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
