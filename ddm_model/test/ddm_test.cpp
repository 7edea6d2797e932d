// Tests of a trained model: what it refuses. bindings_test.py compares its results with NumPy.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/ddm.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyImage;
using testing::toyModel;

/// The toy model with one of its parts replaced.
struct Parts {
  ModelOptions options = testing::toyModelOptions();
  int image_size = testing::kToySize;
  int torque_dim = 1;
  Pca pca = toyModel().pca();
  Eigen::VectorXd theta = toyModel().theta();
  Image goal = toyImage(1.0);

  Ddm model() const { return Ddm(options, image_size, torque_dim, pca, theta, goal, ModelInfo()); }
};

TEST(Ddm, RefusesAGoalFeatureWithoutAGoalAndAnImageOfAnotherSize) {
  const Ddm model = toyModel(/*with_goal=*/false);
  EXPECT_FALSE(model.hasGoal());
  EXPECT_TRUE(throwsNaming<std::logic_error>([&] { model.goalFeature(); }, {"goal image"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([] { toyModel().encode(Image(63)); },
                                                  {"64 pixels", "got 63"}));
}

TEST(Ddm, RefusesPartsThatDoNotFitAndValuesThatAreNotFinite) {
  const auto refuses = [](const std::function<void(Parts*)>& spoil, const std::string& fault) {
    Parts parts;
    spoil(&parts);
    return throwsNaming<std::invalid_argument>([&] { parts.model(); }, {fault, "train it again"});
  };
  EXPECT_NO_THROW(Parts().model());
  EXPECT_TRUE(refuses([](Parts* parts) { parts->image_size = 9; },
                      "pixels of the mean image must be 81, got 64"));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->torque_dim = 2; }, "number of parameters"));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->options.pca_dim = 5; },
                      "columns of the PCA basis must be 5, got "));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->goal.pop_back(); },
                      "pixels of the goal image must be 64, got 63"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->theta[5] = nan; },
                      "parameters must be finite, number 5 is nan"));
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->pca.mean[5] = nan; },
                      "mean image must be finite, number 5"));
  EXPECT_TRUE(
      refuses([&](Parts* parts) { parts->pca.basis(3, 3) = nan; }, "PCA basis must be finite"));
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->pca.scale = 0.0F; },
                      "scale of PCA must be > 0 and finite, got 0"));
}

}  // namespace
}  // namespace ddm
