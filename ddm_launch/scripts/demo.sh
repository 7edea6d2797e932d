#!/usr/bin/env bash
# Installs, builds, runs an experiment and draws the result: from a clean system to a learned swing-up.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# shellcheck source=workspace.sh
. "$(dirname "${BASH_SOURCE[0]}")/workspace.sh"

usage() {
  cat <<TEXT
usage: bash demo.sh [--rviz] [--runs FOLDER] [--trials N]

Learns to hold a pendulum at the target from its camera images alone: installs the packages that are
missing (as root, or through sudo), builds the workspace \$DDM_WS, runs one experiment with the real ROS nodes
and draws a learning curve and a film strip. Called again on the same run folder, it resumes.

  --rviz          show camera, prediction and feature space in rviz while it learns, at 25 frames a second
  --runs FOLDER   run folder, default \$DDM_WS/runs/demo
  --trials N      trials after the random one, default 3
  --help          this text

  DDM_WS              catkin workspace to make or use, default ~/ddm_ws
  ROS_PARALLEL_JOBS   compiler jobs, for example -j1; default one per core, two gigabytes for each
  DDM_AVX2            OFF: slower programs that need no AVX2; default ON
TEXT
}

refuse() {
  printf 'demo.sh: %s\n\n' "$*" >&2
  usage >&2
  exit 2
}

parse_arguments() {
  runs='' trials=3 rviz=false
  while (($#)); do
    case $1 in
      --help | -h) usage && exit 0 ;;
      --rviz)
        [[ -n ${DISPLAY:-} ]] || refuse "--rviz needs a screen, and DISPLAY is not set: call it from a desktop, or without --rviz"
        rviz=true
        shift
        continue
        ;;
      --runs) [[ -n ${2:-} ]] || refuse "--runs needs a folder" ;;
      --trials) [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || refuse "--trials must be a whole number >= 1, got '${2:-}'" ;;
      *) refuse "unknown argument '$1'" ;;
    esac
    printf -v "${1#--}" %s "$2"
    shift 2
  done
  # The path is made absolute before the working directory changes.
  [[ -z $runs ]] || runs=$(realpath -m -- "$runs")
}

# Prints inode and time of the last change of a file; nothing if the file does not exist.
identity() {
  stat -c '%i %y' -- "$1" 2>/dev/null || true
}

# Fails unless this call has written FOLDER/summary.yaml, and the file says that the experiment is finished with at
# least TRIALS trials. This file decides because roslaunch always returns 0. A refused experiment leaves the file of an
# earlier call unchanged. An experiment whose trials are all finished already writes the file again.
check_summary() {  # FOLDER TRIALS IDENTITY_BEFORE
  local summary=$1/summary.yaml again="the same command goes on after the last finished trial."
  [[ -f $summary && $(identity "$summary") != "$3" ]] || fail "the experiment wrote no new $summary: it did not finish.
Remedy: read the lines above; $again"
  awk -v least="$2" '$0 == "finished: true" {finished = 1} $1 == "trials:" {trials = $2}
    END {exit !(finished && trials >= least)}' "$summary" ||
    fail "$summary says that the experiment did not finish $2 trials.
Remedy: read the lines above; $again"
}

run_experiment() {
  local port
  port=$(free_master_port)
  say "Learning: one trial of 100 images under random torques, then $trials trials that it plans itself"
  cat <<TEXT
After each trial a model is trained on all images so far, then tried without random torques. A line says how many images
that were, how well the model draws them (V_R) and predicts them (V_P, less is better), and how far from upright the
pendulum was in the end; "success" is less than 10 degrees.
TEXT
  ((port == 11311)) || echo "Another program has port 11311: use ROS_MASTER_URI=http://localhost:$port to look in."
  local before
  before=$(identity "$runs/summary.yaml")
  mkdir -p "$runs" || fail "cannot make the run folder $runs. Remedy: choose another with --runs FOLDER."
  roslaunch -p "$port" ddm_launch experiment.launch preset:=efficient plant:=pendulum seed:=3 \
    trials:="$trials" runs:="$runs" rviz:="$rviz" || fail "roslaunch failed: see its lines above."
  check_summary "$runs" "$trials" "$before"
}

draw_and_print_result() {
  say "Drawing"
  rosrun ddm_launch figure learning_curve "$runs" --out "$runs/learning_curve.png" &
  rosrun ddm_launch figure film_strip "$runs" --out "$runs/film_strip.png" || fail "the film strip was not drawn: see the lines above."
  wait $! || fail "the learning curve was not drawn: see the lines above."
  say "Summary ($runs/summary.yaml)"
  sed 's/^/  /' "$runs/summary.yaml"
  cat <<TEXT

Figures
  $runs/learning_curve.png   error and success of the greedy policy after each trial
  $runs/film_strip.png       the last greedy evaluation that succeeded (if none did: the last one), image by image

What to try next (in a new terminal, first: export PATH=/usr/bin:\$PATH; . $DDM_WS/devel/setup.bash)
  bash $checkout/ddm_launch/scripts/demo.sh --trials $((trials + 5))
      continues with more trials
  rosrun ddm_launch figure film $runs/evaluation_000 --out /tmp/film.webp
      shows the evaluation of the first model as an animation
  bash $checkout/ddm_launch/scripts/test.sh
      runs every test
TEXT
}

main() {
  parse_arguments "$@"
  use_system_environment
  check_system
  ensure_localhost_resolves
  make_workspace
  runs=${runs:-$DDM_WS/runs/demo}
  install_packages "${packages_to_run[@]}"
  install_by_rosdep
  say "Building (Release) into $DDM_WS/devel"
  build_release || fail "the build failed: see the first error above."
  source_setup "$DDM_WS/devel/setup.bash"
  run_experiment
  draw_and_print_result
}

# If a test sources this file, only the functions are defined.
[[ ${BASH_SOURCE[0]} != "$0" ]] || main "$@"
