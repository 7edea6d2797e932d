// planning_budget: how closely decisions keep mpc/time_budget, on an idle or a busy machine.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/networks.h>
#include <ddm_model/solver_log.h>
#include <ddm_mpc/controller.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "resolution.h"

namespace ddm {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kTrialSteps = 100;
constexpr double kPeriods = 2.0;  // budgets from one image to the next

constexpr char kAbout[] =
    "Prints a row of planning_budget.csv: decisions about images that come at a fixed rate, where "
    "no search for a plan ends before its budget. The models have the preset's sizes and random "
    "parameters.\n\n"
    "usage: rosrun ddm_launch planning_budget --preset efficient [--busy]";

struct BudgetArguments {
  std::string preset = "efficient";
  double budget = 0.005;
  int plans = 2000;
  bool busy = false;
};

/// One process per core that does nothing but compute.
class BusyCores {
 public:
  explicit BusyCores(bool busy) {
    const unsigned count = busy ? std::max(1U, std::thread::hardware_concurrency()) : 0;
    for (unsigned i = 0; i < count; ++i) {
      const pid_t child = fork();
      if (child < 0) throw std::runtime_error("no process can be started to keep a core busy");
      if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        const sched_param lowest{};  // whatever priority this program was given
        if (sched_setscheduler(0, SCHED_OTHER, &lowest) != 0) _exit(EXIT_FAILURE);
        for (volatile unsigned sum = 0;;) sum = sum + 1;
      }
      children_.push_back(child);
    }
  }
  BusyCores(const BusyCores&) = delete;
  ~BusyCores() {
    for (const pid_t child : children_) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
  }

 private:
  std::vector<pid_t> children_;
};

std::mt19937_64 fixedStream() { return std::mt19937_64(1); }

Grey randomGrey(int image_size, std::mt19937_64* rng) {
  std::uniform_int_distribution<int> byte(0, 255);
  Grey grey(static_cast<std::size_t>(image_size) * image_size);
  for (std::uint8_t& value : grey) value = static_cast<std::uint8_t>(byte(*rng));
  return grey;
}

/// How long a plan takes does not depend on what the model has learned.
std::shared_ptr<const Ddm> randomModel(const ModelConfig& config, std::mt19937_64* rng) {
  std::normal_distribution<double> normal(0.0, 0.3);
  const auto draw = [&] { return normal(*rng); };
  const Networks<double> networks(config.model, /*torque_dim=*/1);
  const Eigen::Index num_pixels = config.image.size * config.image.size;
  Pca pca;
  pca.mean = Eigen::VectorXf::Constant(num_pixels, 0.5F);
  pca.basis = Eigen::MatrixXd::NullaryExpr(num_pixels, config.model.pca_dim, draw).cast<float>() /
              static_cast<float>(config.image.size);
  pca.variance = Eigen::VectorXd::Ones(config.model.pca_dim);
  const Eigen::VectorXd theta = Eigen::VectorXd::NullaryExpr(networks.numParams(), draw);
  const int memory = config.model.memory();
  ModelInfo info;  // as many landmarks as a training keeps
  info.landmarks =
      Eigen::MatrixXd::NullaryExpr(memory * config.model.feature_dim + memory - 1, 1000, draw)
          .cast<float>();
  return std::make_shared<const Ddm>(config.model, config.image.size, 1, pca, theta,
                                     randomGrey(config.image.size, rng), info);
}

/// @return time from each image to the end of its decision [s]
std::vector<double> decide(const BudgetArguments& arguments, int* cut_short) {
  Arguments given;
  given.set("experiment/preset", arguments.preset);
  ParamReader reader = resolve(given).reader();
  const Configuration all = readConfiguration(&reader);
  MpcOptions mpc = all.mpc;
  mpc.time_budget = arguments.budget;
  mpc.num_starts = 1000;  // as many as are allowed, and none of them converges
  mpc.max_iterations = 1000000;
  mpc.function_tolerance = 0.0;
  std::mt19937_64 rng = fixedStream();
  MpcPolicy policy(randomModel(all.model, &rng), mpc);
  const auto period =
      std::chrono::duration_cast<Clock::duration>(Seconds(kPeriods * arguments.budget));
  std::vector<double> times;
  Clock::time_point due = Clock::now();
  for (int i = 0; i < arguments.plans; ++i) {
    if (i % kTrialSteps == 0) policy.startTrial(TrialId());
    const Grey grey = randomGrey(all.model.image.size, &rng);
    due = std::max(due + period, Clock::now());
    std::this_thread::sleep_until(due);
    policy.observe(grey);
    const Plan plan = policy.plan();
    times.push_back(Seconds(Clock::now() - due).count());
    policy.apply(plan.torques.col(0));
    if (plan.status == PlanStatus::kTimeLimit) ++*cut_short;
  }
  return times;
}

void run(const BudgetArguments& arguments) {
  const BusyCores cores(arguments.busy);
  int cut_short = 0;
  const std::vector<double> times = decide(arguments, &cut_short);
  const auto withinOf = [&](double slack) {
    return formatDouble(
        static_cast<double>(std::count_if(
            times.begin(), times.end(), [&](double t) { return t <= arguments.budget + slack; })) /
        static_cast<double>(times.size()));
  };
  std::cout << arguments.preset << "," << (arguments.busy ? "busy" : "idle") << ","
            << formatDouble(1e3 * arguments.budget) << "," << arguments.plans << "," << cut_short;
  for (const double q : {0.5, 0.99, 0.999, 1.0}) {
    std::cout << "," << formatDouble(1e3 * quantile(times, q));
  }
  std::cout << "," << withinOf(0.002) << "," << withinOf(0.010) << "\n";
}

bool parse(int argc, char** argv, BudgetArguments* arguments) {
  namespace po = boost::program_options;
  po::options_description options(std::string(kAbout) + "\n\noptions");
  options.add_options()("preset", po::value(&arguments->preset)->default_value("efficient"),
                        "name in ddm_launch/config/presets");
  options.add_options()("budget", po::value(&arguments->budget)->default_value(0.005),
                        "mpc/time_budget [s]");
  options.add_options()("plans", po::value(&arguments->plans)->default_value(2000),
                        "decisions to time");
  options.add_options()("busy", po::bool_switch(&arguments->busy),
                        "keep every core busy with a process of its own meanwhile");
  if (!parseCommandLine(argc, argv, options)) return false;
  if (!(arguments->budget > 0.0 && arguments->budget <= 1.0) || arguments->plans < 1) {
    throw std::invalid_argument("--budget must lie in (0, 1] and --plans must be >= 1");
  }
  return true;
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  ddm::BudgetArguments arguments;
  return ddm::runTool(
      "planning_budget", [&] { return ddm::parse(argc, argv, &arguments); },
      [&] { ddm::run(arguments); });
}
