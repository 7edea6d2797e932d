// PILCO's observation by an auto-encoder that is trained alone: 2-D features of one image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <optional>

#include "configuration.h"
#include "observation.h"
#include "pilco_options.h"

namespace ddm {

/// x = z = g^-1(y). The auto-encoder minimises V_R alone (training/schedule v_r_only), on the
/// random trial at first, and anew on all data after each trial.
class FeatureObservation : public Observation {
 public:
  /// @throws std::invalid_argument if training/schedule trains more than the auto-encoder
  FeatureObservation(ModelConfig model, const PilcoOptions& options);

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  bool keepsCoordinates() const override { return false; }
  PilcoTask task() const override { return *task_; }
  std::map<std::string, std::string> files() const override;
  void startTrial(const TrialId& /*id*/) override {}
  Eigen::VectorXd observe(const Grey& grey) override { return model_->encode(grey); }

 private:
  ModelConfig config_;
  PilcoOptions options_;
  std::optional<Ddm> model_;
  std::optional<PilcoTask> task_;
};

}  // namespace ddm
