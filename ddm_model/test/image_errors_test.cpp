// Tests of image errors: what a model keeps of images, by hand.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/image_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ddm_model/pca.h"
#include "toy_data.h"

namespace ddm {
namespace {

/// A model whose principal components are those of the data.
Ddm modelWithPcaOf(const DataSet& data) {
  const Ddm random = testing::toyModel();
  return Ddm(random.options(), testing::kToySize, 1, fitPca(data, random.options().pca_dim, 1.0),
             random.theta(), Grey(), ModelInfo());
}

double rmsDistance(const Grey& a, const Grey& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow((a[i] - b[i]) / 255.0, 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(ImageErrors, OfReconstructionsAreThoseOfEachFrame) {
  const DataSet data = testing::toyTrial(20, 1);
  const Ddm model = modelWithPcaOf(data);
  const ImageErrors errors = imageErrors(model, data);
  ASSERT_EQ(errors.reconstruction.size(), 20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    const Grey y_hat = model.decode(model.encode(data.image(i)));
    EXPECT_NEAR(errors.reconstruction[i], rmsDistance(y_hat, data.image(i)), 1e-12) << i;
  }
}

TEST(ImageErrors, SharesOfComponentsAndWhatTheyLoseMakeUpTheWhole) {
  const DataSet data = testing::toyTrial(40, 1);
  const ImageErrors errors = imageErrors(modelWithPcaOf(data), data);
  const double lost = errors.pca.squaredNorm() / errors.mean.squaredNorm();
  EXPECT_NEAR(errors.component_share.sum() + lost, 1.0, 1e-5);
  EXPECT_GT(lost, 1e-4);  // or the sum above says little
  for (Eigen::Index i = 1; i < errors.component_share.size(); ++i) {
    EXPECT_LE(errors.component_share[i], errors.component_share[i - 1] + 1e-9) << i;
  }
}

TEST(ImageErrors, VariationIsThatOfTheImagesAroundTheirOwnMean) {
  DataSet data(testing::kToySize, 1);
  const Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  const Ddm model = modelWithPcaOf(testing::toyTrial(20, 1));
  for (int i = 0; i < 3; ++i) data.append(testing::toyImage(1.0), u, i == 0);
  EXPECT_NEAR(imageErrors(model, data).variation, 0.0, 1e-7);
  data = DataSet(testing::kToySize, 1);
  const Grey dark(64, 51), light(64, 102);  // 0.1 to either side of 0.3
  for (const Grey& grey : {dark, light}) data.append(grey, u, false);
  EXPECT_NEAR(imageErrors(model, data).variation, 0.1, 1e-9);
}

TEST(ImageErrors, RefuseImagesOfAnotherSizeAndNone) {
  const Ddm model = testing::toyModel();
  EXPECT_THROW(imageErrors(model, testing::toyTrial(3, 1, 9)), std::invalid_argument);
  EXPECT_THROW(imageErrors(model, DataSet(testing::kToySize, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
