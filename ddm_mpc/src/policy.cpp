// A policy: which torque answers the image just seen.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/policy.h"

#include <utility>

namespace ddm {

Answer answerWith(Plan plan) {
  Answer answer;
  answer.torque = plan.torques.col(0);
  answer.solve_time = plan.solve_time;
  answer.plan = std::move(plan);
  return answer;
}

}  // namespace ddm
