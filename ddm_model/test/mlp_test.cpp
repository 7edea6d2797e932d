// Tests of the fully connected network: gradients, memory (bindings_test.py compares its values).
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/mlp.h"

#include <gtest/gtest.h>

#include "ddm_model/testing/gradient_check.h"
#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

using Net = Mlp<double>;
using testing::randomMatrix;

const std::vector<std::vector<int>> kDepths = {{4, 2}, {4, 5, 2}, {4, 6, 3, 6, 2}};
const Net::Output kOutputs[] = {Net::Output::kLinear, Net::Output::kArctan};

TEST(Mlp, GradientInThetaAndInputsMatchesDifferencesForEveryDepthAndOutput) {
  for (const auto& widths : kDepths) {
    for (Net::Output output : kOutputs) {
      const Net net(widths, output);
      const Eigen::Index num_params = net.numParams();
      const Eigen::MatrixXd targets = randomMatrix(2, 3, 2);
      // |net(inputs) - targets|^2 as a function of theta, then the inputs.
      const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
        Net::Tape tape;
        net.forward(x.data(), Eigen::Map<const Eigen::MatrixXd>(x.data() + num_params, 4, 3),
                    &tape);
        const Eigen::MatrixXd residual = tape.output() - targets;
        Eigen::VectorXd d_theta = Eigen::VectorXd::Zero(num_params);
        Eigen::MatrixXd d_inputs;
        net.backward(x.data(), &tape, 2.0 * residual, d_theta.data(), &d_inputs);
        if (gradient != nullptr) {
          gradient->resize(x.size());
          *gradient << d_theta, Eigen::Map<Eigen::VectorXd>(d_inputs.data(), 12);
        }
        return residual.squaredNorm();
      };
      EXPECT_TRUE(testing::gradientMatches(f, randomMatrix(num_params + 12, 1, 3)))
          << widths.size() - 1 << " layers, output " << static_cast<int>(output);
    }
  }
}

TEST(Mlp, ATapeServesBatchesThatShrinkAndGrow) {
  const Net net({4, 5, 2}, Net::Output::kArctan);
  const Eigen::VectorXd theta = randomMatrix(net.numParams(), 1, 1);
  Net::Tape used;
  for (int size : {0, 9, 3, 1, 0, 12}) {
    const Eigen::MatrixXd inputs = randomMatrix(4, size, 10 + size);
    const Eigen::MatrixXd d_outputs = randomMatrix(2, size, 20 + size);
    Eigen::VectorXd d_theta[2];
    Eigen::MatrixXd output[2], d_inputs[2];
    Net::Tape fresh;
    Net::Tape* const tapes[] = {&used, &fresh};
    for (int i = 0; i < 2; ++i) {
      d_theta[i] = Eigen::VectorXd::Zero(theta.size());
      net.forward(theta.data(), inputs, tapes[i]);
      output[i] = tapes[i]->output();
      net.backward(theta.data(), tapes[i], d_outputs, d_theta[i].data(), &d_inputs[i]);
    }
    EXPECT_EQ(output[0].cols(), size);
    EXPECT_TRUE(output[0] == output[1] && d_theta[0] == d_theta[1] && d_inputs[0] == d_inputs[1])
        << size << " samples";
  }
}

TEST(Mlp, RandomWeightsHaveTheSpreadOfTheirFanInAndNoBias) {
  const Net net({400, 50, 3}, Net::Output::kLinear);
  Eigen::VectorXd theta(net.numParams());
  std::mt19937_64 rng(1);
  randomise(net, &rng, theta.data());
  const double spread = std::sqrt(net.weights(theta.data(), 0).array().square().mean());
  EXPECT_NEAR(spread, 1.0 / 20.0, 0.001);
  EXPECT_EQ(net.biases(theta.data(), 0).norm(), 0.0);
  EXPECT_EQ(net.biases(theta.data(), 1).norm(), 0.0);
}

#ifdef __x86_64__
TEST(Rounding, DoesNotDependOnTheCachesOfThisProcessor) {
  // Eigen splits the sums in matrix products by these sizes.
  EXPECT_EQ(Eigen::l1CacheSize(), 32 * 1024);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 * 1024);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 * 1024 * 1024);
}
#endif

}  // namespace
}  // namespace ddm
