// A method: what learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#include "method.h"

#include "ddm_method.h"
#include "oracle_method.h"

namespace ddm {

std::unique_ptr<Method> makeMethod(const Configuration& configuration, const Plant& plant) {
  if (configuration.experiment.method == "oracle") {
    return std::make_unique<OracleMethod>(configuration, plant);
  }
  return std::make_unique<DdmMethod>(configuration);
}

}  // namespace ddm
