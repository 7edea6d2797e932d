// PILCO's observation by principal components: scores of one image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/pca.h>

#include <optional>

#include "configuration.h"
#include "observation.h"
#include "pilco_options.h"

namespace ddm {

/// x = PCA scores, model/pca_dim of them (paper, Sec. 4.2: 20). Fitted anew after each trial.
class PcaObservation : public Observation {
 public:
  PcaObservation(const ModelConfig& model, const PilcoOptions& options)
      : config_(model), options_(options) {}

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  bool keepsCoordinates() const override { return false; }
  PilcoTask task() const override { return *task_; }
  void startTrial(const TrialId& /*id*/) override {}
  Eigen::VectorXd observe(const Grey& grey) override;

 private:
  ModelConfig config_;
  PilcoOptions options_;
  Pca pca_;
  std::optional<PilcoTask> task_;
};

}  // namespace ddm
