// Keeps the solver library's chatter off the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/solver_log.h"

#include <glog/logging.h>

namespace ddm {

void silenceSolverLog() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace ddm
