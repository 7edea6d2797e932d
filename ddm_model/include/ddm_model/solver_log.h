// Keeps the solver library's chatter off the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {

/// Ceres warns on stderr about line searches over flat functions, which are no news to a user: how
/// a solver ended is in every result. Called once by a program, never by a library.
void silenceSolverLog();

}  // namespace ddm
