// instruction_probe: evaluates the objective with its gradient, or plans, so many times; for
// callgrind. SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/objective.h>
#include <ddm_model/solver_log.h>
#include <ddm_model/testing/random_matrix.h>
#include <ddm_mpc/ddm_plan_cost.h>
#include <ddm_mpc/planner.h>

#include <cstdlib>
#include <iostream>
#include <string>

namespace ddm {
namespace {

constexpr int kFrames = 1600;
constexpr int kImageSize = 8;

/// The paper's networks on as many frames as 16 trials have.
void evaluateObjective(int count) {
  const ModelOptions options;
  const Networks<float> networks(options, 1);
  TrainingData<float> data;
  data.scores = testing::randomMatrix(options.pca_dim, kFrames + 1, 1).cast<float>();
  data.torques = options.max_torque[0] * testing::randomMatrix(1, kFrames, 2);
  data.pieces = {{0, kFrames}};
  JointObjective<float> objective(networks, data);
  const Eigen::VectorXf theta =
      0.1F * testing::randomMatrix(networks.numParams(), 1, 3).cast<float>();
  Eigen::VectorXf d_theta;
  for (int i = 0; i < count; ++i) objective.evaluate(theta, &d_theta);
}

/// The paper's planner from one state, from scratch each time.
void plan(int count) {
  ModelOptions options;
  options.pca_dim = 10;
  const Networks<double> networks(options, 1);
  Pca pca;
  pca.mean.setZero(kImageSize * kImageSize);
  pca.basis.setIdentity(kImageSize * kImageSize, options.pca_dim);
  pca.variance.setOnes(options.pca_dim);
  const Ddm model(options, kImageSize, 1, pca,
                  0.3 * testing::randomMatrix(networks.numParams(), 1, 4),
                  Grey(kImageSize * kImageSize, 200), ModelInfo());
  const MpcOptions mpc;
  DdmPlanCost cost(model, mpc.horizon, mpc.control_weight);
  History x(options.order, options.feature_dim, 1);
  x.observe(model.encode(Grey(kImageSize * kImageSize, 30)));
  cost.setProblem(x, model.goalFeature());
  Planner planner(&cost, mpc);
  for (int i = 0; i < count; ++i) {
    planner.clear();
    std::mt19937_64 rng(5);
    planner.solve(&rng);
  }
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  const std::string what = argc == 3 ? argv[1] : "";
  if (what != "objective" && what != "plan") {
    std::cerr << "usage: instruction_probe objective|plan COUNT\n";
    return EXIT_FAILURE;
  }
  (what == "plan" ? ddm::plan : ddm::evaluateObjective)(std::atoi(argv[2]));
}
