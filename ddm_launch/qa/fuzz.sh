#!/usr/bin/env bash
# Builds the fuzz targets with sanitizers and runs them: what reads bytes from outside is fed rubbish.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/workspace.sh"
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
. "$(dirname "${BASH_SOURCE[0]}")/sanitized.sh"

usage() {
  cat <<TEXT
usage: bash ddm_launch/qa/fuzz.sh --out DIR [--runs N] [--only TARGET...] [--jobs N] [--seed S]

Installs the packages that are missing (as root, or through sudo), builds the fuzz targets with clang into
\$DDM_WS/debug, and runs them. The same call again goes on where it ended.

  DDM_WS              catkin workspace to make or use, default ~/ddm_ws
  ROS_PARALLEL_JOBS   compiler jobs, for example -j1; default one per core, two gigabytes for each

TEXT
  DDM_WS=${DDM_WS:-$HOME/ddm_ws} run_fuzzing --help
}

main() {
  use_system_environment
  if [[ $# == 0 || " $* " == *" --help "* || " $* " == *" -h "* ]]; then
    usage
    exit 0
  fi
  check_system
  make_workspace
  install_packages "${packages_to_run[@]}" "${packages_to_test[@]}"
  install_by_rosdep
  build_sanitized address -DDDM_PILCO=ON fuzz_targets
  run_fuzzing "$@"
}

main "$@"
