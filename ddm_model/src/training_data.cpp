// What the objective is computed from: PCA scores and torques of a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/training_data.h"

namespace ddm {

TrainingData<float> makeTrainingData(const DataSet& data, const Pca& pca) {
  TrainingData<float> out;
  out.scores = pca.project(data);
  out.torques = data.torques();
  out.pieces = data.pieces();
  return out;
}

}  // namespace ddm
