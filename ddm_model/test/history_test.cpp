// Tests of the controller state, and of support states: that they lie where the states are, and evenly.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

Eigen::VectorXd scalar(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(History, TheFirstFeatureStandsForThoseBeforeItAtRest) {
  History x(3, 2, 1);
  EXPECT_TRUE(x.empty());
  x.observe(Eigen::Vector2d(1.0, 2.0));
  EXPECT_FALSE(x.empty());
  Eigen::MatrixXd expected(2, 3);
  expected << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0;
  EXPECT_EQ(x.features(), expected);
  EXPECT_EQ(x.torques(), Eigen::MatrixXd::Zero(1, 2));
}

TEST(History, KeepsTheNewestFirstAndForgetsTheOldest) {
  History x(3, 1, 1);
  for (int t = 0; t < 5; ++t) {
    x.observe(scalar(t));
    if (t < 4) x.apply(scalar(10 + t));
  }
  EXPECT_EQ(x.features(), Eigen::RowVector3d(4.0, 3.0, 2.0));  // z_t, z_{t-1}, z_{t-2}
  EXPECT_EQ(x.torques(), Eigen::RowVector2d(13.0, 12.0));      // u_{t-1}, u_{t-2}
}

Eigen::MatrixXf columns(const Eigen::MatrixXf& Z, const std::vector<Eigen::Index>& chosen) {
  Eigen::MatrixXf out(Z.rows(), static_cast<Eigen::Index>(chosen.size()));
  for (size_t i = 0; i < chosen.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = Z.col(chosen[i]);
  return out;
}

TEST(FarthestPoints, AreAsFarApartAsOthersAreFromThem) {
  // a dense cloud and a thin line: a random choice would be nearly all cloud
  Eigen::MatrixXf Z(2, 1100);
  Z.leftCols(1000) = 0.01F * testing::randomMatrix(2, 1000, 2).cast<float>();
  for (int i = 0; i < 100; ++i) Z.col(1000 + i) << 0.01F * static_cast<float>(i + 1), 0.0F;
  const Eigen::MatrixXf support_states = columns(Z, farthestPoints(Z, 30));
  float apart = 1e9F, missed = 0.0F;
  for (Eigen::Index i = 0; i < support_states.cols(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      apart = std::min(apart, (support_states.col(i) - support_states.col(j)).norm());
    }
  }
  for (Eigen::Index i = 0; i < Z.cols(); ++i) {
    missed = std::max(missed, (support_states.colwise() - Z.col(i)).colwise().norm().minCoeff());
  }
  EXPECT_GE(apart, missed);
  EXPECT_LT(missed, 0.05F);
}

TEST(SupportStates, AreStatesOfOneMotionEach) {
  // z_t = t, u_t = 10 t, in two segments of different length
  DataSet data(2, 1);
  Eigen::MatrixXf Z(1, 7);
  for (int t = 0; t < 7; ++t) {
    data.append(Image(4, 0), Eigen::VectorXd::Constant(1, 10.0 * t), /*new_segment=*/t == 4);
    Z(0, t) = static_cast<float>(t);
  }
  const Eigen::MatrixXf support_states = supportStates(Z, data, /*order=*/3, /*max_count=*/100);
  ASSERT_EQ(support_states.rows(), 3 + 2);  // z_t, z_{t-1}, z_{t-2}, u_{t-1}, u_{t-2}
  ASSERT_EQ(support_states.cols(), 7);
  for (Eigen::Index i = 0; i < 7; ++i) {
    const Eigen::VectorXf x = support_states.col(i);
    // Of the segment: before it the plant was at rest.
    const float begin = x[0] < 4.0F ? 0.0F : 4.0F;
    EXPECT_EQ(x[1], std::max(x[0] - 1.0F, begin));
    EXPECT_EQ(x[2], std::max(x[0] - 2.0F, begin));
    EXPECT_EQ(x[3], x[0] > begin ? 10.0F * (x[0] - 1.0F) : 0.0F);
    EXPECT_EQ(x[4], x[0] > begin + 1.0F ? 10.0F * (x[0] - 2.0F) : 0.0F);
  }
}

TEST(FarthestPoints, AreFewerWhereThereAreFewerDifferentOnes) {
  const Eigen::MatrixXf few = testing::randomMatrix(2, 5, 3).cast<float>();
  EXPECT_EQ(farthestPoints(few, 10).size(), 5U);
  EXPECT_EQ(farthestPoints(few.col(2).replicate(1, 9), 10).size(), 1U);
}

}  // namespace
}  // namespace ddm
