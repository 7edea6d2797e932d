#!/usr/bin/env bash
# Installs, builds Release and Debug, runs every test, and closes with the line "N passed, N failed".
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
# shellcheck source=workspace.sh
. "$(dirname "${BASH_SOURCE[0]}")/workspace.sh"

usage() {
  cat <<TEXT
usage: bash test.sh [-R PATTERN | --thread-sanitizer | --fuzz DIR [RUNS]]

Installs the packages that are missing (as root, or through sudo), builds the workspace \$DDM_WS, and
runs every test: gtest, rosunit, rostest, roslaunch-check and the linters on the Release build; the gtests of the core
once more, a short experiment and short fuzzing on a Debug build by clang, with Eigen's assertions, AddressSanitizer,
UndefinedBehaviorSanitizer, and warnings as errors. A case that runs in several builds counts once; one that is
skipped does not count and is named. Returns 1 if any case fails, if a test leaves no result, or if a sanitizer
reports anything.

  -R PATTERN          instead of all that: the Release build, and the tests whose names match this regular expression,
                      for example -R 'python_film|ddm_mpc_test'
  --thread-sanitizer  instead of all that: what has several threads, on a Debug build with ThreadSanitizer
  --fuzz DIR [RUNS]   instead of all that: feeds random bytes to everything that reads bytes from outside, RUNS (default
                      100000) inputs for each target. DIR gets a table fuzzing.csv; logs/, what each target said; corpus/,
                      from which the next call continues; and findings/, the inputs that break a promise
  --help              this text

  DDM_WS              catkin workspace to make or use, default ~/ddm_ws (Release in devel/, Debug in debug/devel/,
                      ThreadSanitizer in thread/devel/)
  ROS_PARALLEL_JOBS   compiler jobs, for example -j1; default one per core, two gigabytes for each
  DDM_AVX2            OFF: slower programs that need no AVX2; default ON
  CI                  if set, warnings are errors in the Release build too
  DDM_PILCO_VECTORS   file of reference values for PILCO, with which ddm_pilco_vectors_test must agree; if not set, that test
                      is skipped
TEXT
}

# Packages that only the tests need: linters, the check of .rosinstall, sanitizers with symbols in their reports, a
# compiler for arm64, a virtual screen for rviz, and servers that play other machines.
packages_to_test=(
  catkin-lint python3-wstool clang-format clang-tidy shellcheck flake8 git python3-pytest
  clang libclang-rt-dev libomp-dev llvm
  g++-aarch64-linux-gnu
  xvfb imagemagick
  openssh-client openssh-server iproute2 nftables
  slurmctld slurmd slurm-client munge
)
optional_packages+=(
  catkin-lint            # has another name with Noetic
  python3-wstool         # not in Debian 13
  libclang-rt-dev        # part of clang itself in Debian 11
  g++-aarch64-linux-gnu  # does not exist where arm64 is the native architecture
)

# Runs a command as root. While it runs, no package may start a service (Debian policy 9.11.1: policy-rc.d). Afterwards,
# services of new packages are disabled, because the tests start their own daemons and a user did not ask for an sshd.
without_services='
policy=${POLICY_RC_D:-/usr/sbin/policy-rc.d}
if [ ! -e "$policy" ]; then
  printf "#!/bin/sh\nexit 101\n" >"$policy" && chmod 755 "$policy"
  trap "rm -f $policy" EXIT
fi
units=
for unit in munge slurmctld slurmd ssh; do
  [ -e /lib/systemd/system/$unit.service ] || units="$units $unit"
done
"$@" || exit
for unit in $units; do
  [ ! -e /lib/systemd/system/$unit.service ] || ! command -v systemctl >/dev/null || systemctl disable $unit
done'
around_apt=(sh -c "$without_services" sh)  # for apt_install in workspace.sh

loop_programs=(sim_node mpc_node view_node trial_recorder model_node experiment_node run_experiment evaluate)
# Tests of algorithms and of code that reads bytes from outside. The other gtests take long to compile.
gtest_programs=(
  ddm_bag_io_test ddm_common_test ddm_images_test ddm_model_config_test ddm_model_test ddm_mpc_test ddm_msgs_test
  ddm_node_test ddm_robot_test
)
debug_targets=("${loop_programs[@]}" "${gtest_programs[@]}" fuzz_targets)
debug_tests="_gtest_($(IFS='|' && echo "${gtest_programs[*]}"))\$"
threaded_programs=(
  model_node_test mpc_node_stop_test mpc_node_test experiment_node robot_node train_from_bags trial_recorder_test
)
threaded_tests='^_ctest_ddm_[a-z]+_(rostest_test_(model_node|mpc_node|robot_node|trial_recorder)\.test|python_replay)$'

parse_arguments() {
  mode=all
  (($# == 0)) && return
  [[ " $* " == *" --help "* || " $* " == *" -h "* ]] && usage && exit 0
  [[ $1 == -R && $# == 2 ]] && mode=part && pattern=$2 && return
  [[ $1 == --thread-sanitizer && $# == 1 ]] && mode=thread && return
  [[ $1 == --fuzz && $# -ge 2 && ${3:-1} =~ ^[0-9]+$ ]] && mode=fuzz && return
  printf 'test.sh: unknown argument %s\n\n' "'$1'" >&2
  usage >&2
  exit 2
}

# Runs the tests of a build folder with matching names, one per core at a time. CMake marks tests that must run alone.
# The result files contain the failures.
run_tests() {  # BUILD_FOLDER PATTERN
  cd "$1" || return
  rm -rf test_results/* Testing  # removes the results of earlier calls
  : >DartConfiguration.tcl  # -T needs this file; all its settings are optional
  ctest -T Test -j "$(nproc)" -R "$2" --output-on-failure --timeout 600 </dev/null && return
  # Shows failures now, before the other builds are finished.
  /usr/bin/python3 "$checkout/ddm_launch/qa/test_report.py" "$1" | grep -A 40 '^FAILED' || true
}

# Builds in $DDM_WS/debug with AddressSanitizer, or in $DDM_WS/thread with ThreadSanitizer: with a portable instruction
# set, so that reports are the same on all machines, and with -O1, because unoptimised Eigen needs minutes for seconds of
# Release.
build_sanitized() {  # debug|thread TARGET...
  local folder=$DDM_WS/$1 jobs
  read -ra jobs < <(job_flags)
  make_devel_space "$folder/devel"
  catkin_make -C "$DDM_WS" --build "$folder/build" "${jobs[@]}" \
    -DCATKIN_DEVEL_PREFIX="$folder/devel" -DCMAKE_INSTALL_PREFIX="$folder/install" -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG='-O1 -gline-tables-only' -DDDM_AVX2=OFF -DDDM_WERROR=ON \
    -DDDM_SANITIZE="${1/debug/address}" -DDDM_PILCO=OFF "${unity_flags[@]}" "${@:2}"
}

# Runs a short experiment with each driver, and several evaluations at a time. A program that does not finish counts as
# a report.
short_loop() {  # debug|thread REPORTS
  local out=$DDM_WS/$1/loop programs=$DDM_WS/$1/devel/lib/ddm_launch
  rm -rf "$out"
  mkdir -p "$out"
  source_setup "$DDM_WS/$1/devel/setup.bash"
  {
    "$programs/run_experiment" --preset debug --trials 1 --out "$out/process" &&
      "$programs/evaluate" --preset debug --model "$out/process/trial_001/model.ddm" --seeds 0:8 --jobs 4 --out "$out/evaluate"
  } </dev/null >"$out/process.log" 2>&1 || cp "$out/process.log" "$2/one_process"
  timeout -s INT -k 30 300 roslaunch -p "$(free_master_port)" ddm_launch experiment.launch preset:=debug trials:=1 view:=true \
    runs:="$out/nodes" </dev/null >"$out/nodes.log" 2>&1 || true
  [[ -f $out/nodes/summary.yaml ]] || cp "$out/nodes.log" "$2/nodes"
}

# The option of AddressSanitizer that says whether leaks count. In Debian 11 and with Noetic, log4cxx and
# class_loader do not free their memory when a program ends.
leaks=detect_leaks=1
if compgen -G '/usr/lib/*/liblog4cxx.so.1[01]' >/dev/null; then leaks=detect_leaks=0; fi

# Runs the tests and the loop. test_report.py counts each file in build/sanitizer_reports as a failure.
run_sanitized() {  # debug|thread PATTERN
  local reports=$DDM_WS/$1/build/sanitizer_reports
  rm -rf "$reports"
  mkdir -p "$reports"
  export ASAN_OPTIONS=log_path=$reports/report:$leaks:detect_stack_use_after_return=1:strict_string_checks=1
  export UBSAN_OPTIONS=log_path=$reports/report:print_stacktrace=1
  # The libraries of ROS are not instrumented. The last option ignores them, because their locks are invisible.
  export TSAN_OPTIONS=log_path=$reports/report:suppressions=$checkout/ddm_launch/qa/thread_suppressions.txt:ignore_noninstrumented_modules=1
  # Informs ThreadSanitizer about the threads of OpenMP, which is not instrumented either.
  OMP_TOOL_LIBRARIES=$(clang++ -print-resource-dir)/../../libarcher.so
  [[ $1 != thread ]] || export OMP_TOOL_LIBRARIES
  short_loop "$1" "$reports"
  run_tests "$DDM_WS/$1/build" "$2"
  if compgen -G "$reports/*" >/dev/null; then tail -n +1 "$reports"/*; else echo "no report"; fi
}

# Runs one target: a program of libFuzzer with sanitizers, and a folder of seeds. The memory limit finds inputs that the
# program does not check. Inputs have at most four times the length of the longest seed, because the time of a run grows
# with the length.
fuzz_target() {  # FOLDER_OF_SEEDS
  local target=${1##*/} package longest start=$SECONDS found=0
  package=$(basename "$(realpath "$1/../../..")")
  longest=$(stat -c %s "$1"/* | sort -n | tail -n 1)
  mkdir -p "$out/corpus/$target"
  FUZZ_TARGET=$target ASAN_OPTIONS=$leaks LD_LIBRARY_PATH=$programs:$LD_LIBRARY_PATH \
    "$programs/$package/${package}_fuzz" -runs="$runs" -seed="$seed" -max_len=$((longest < 64 ? 256 : 4 * longest)) \
    -malloc_limit_mb=64 -rss_limit_mb=2048 -timeout=30 -artifact_prefix="$out/findings/$target-" \
    "$out/corpus/$target" "$1" >"$out/logs/$target.txt" 2>&1 || found=1
  ((found == 0)) || { tail -n 40 "$out/logs/$target.txt" && echo "FOUND by $target: see $out/findings and $out/logs/$target.txt"; }
  echo "$target,$((found ? 0 : runs)),$((SECONDS - start)),$(find "$out/corpus/$target" -type f | wc -l),$found" >>"$out/fuzzing.csv"
  return "$found"
}

# Runs all targets, one per core at a time.
run_fuzzing() {  # DIR RUNS SEED
  local out=$1 runs=$2 seed=$3 programs=$DDM_WS/debug/devel/lib
  export out runs seed programs leaks
  export -f fuzz_target
  mkdir -p "$out"/{logs,corpus,findings}
  echo "target,runs,seconds,corpus_files,findings" >"$out/fuzzing.csv"
  printf '%s\n' "$checkout"/ddm_*/fuzz/corpus/* | xargs -P "$(nproc)" -I FOLDER bash -c 'fuzz_target FOLDER'
}

# Fuzzes from the committed seeds, always with the same random numbers. A finding counts as a report of a sanitizer.
fuzz_shortly() {
  local out=$DDM_WS/debug/fuzzing reports=$DDM_WS/debug/build/sanitizer_reports
  rm -rf "$out"
  mkdir -p "$out"
  run_fuzzing "$out" 1000 1 2>&1 | tee "$out/output.txt" || cp "$out/output.txt" "$reports/fuzzing"
  cat "$out/fuzzing.csv"
}

# Starts the Debug build in its own process group. Its processes run only while the tests leave a core idle.
start_debug_build() {
  mkdir -p "$DDM_WS/debug"
  set -m
  (renice -n 19 "$BASHPID" && build_sanitized debug "${debug_targets[@]}") >"$DDM_WS/debug/build.log" 2>&1 </dev/null &
  set +m
  debug_build=$!
}

finish_debug_build() {
  local build=$debug_build
  say "Debug build with AddressSanitizer into $DDM_WS/debug/devel"
  tail --pid="$build" -n 1 -f "$DDM_WS/debug/build.log"  # shows progress
  debug_build=''  # the process id can belong to another process after the build has ended
  wait "$build" || {
    cat "$DDM_WS/debug/build.log"
    fail "the Debug build failed. Remedy: see the first error above."
  }
}

phase() {  # TITLE COMMAND...
  local title=$1 code=0
  shift
  say "$title ($SECONDS s after the start)"
  ("$@") || code=$?
  ((code == 0)) || fail "$title: failed with code $code. Remedy: see the first error above."
}

# Builds and runs the tests of a mode. Sets `results` to the build folders.
run_mode() {
  if [[ $mode == thread ]]; then
    phase "Build with ThreadSanitizer into $DDM_WS/thread/devel" \
      build_sanitized thread "${loop_programs[@]}" "${threaded_programs[@]}"
    phase "Tests of threads and a short loop with ThreadSanitizer" run_sanitized thread "$threaded_tests"
    results=("$DDM_WS/thread/build")
    return
  fi
  phase "Release build into $DDM_WS/devel" build_release all tests
  results=("$DDM_WS/build")
  # The Debug build uses the processor time during which the tests wait.
  [[ $mode == part ]] || start_debug_build
  phase "Tests on the Release build" run_tests "$DDM_WS/build" "$pattern"
  [[ $mode == part ]] && return
  finish_debug_build
  phase "gtests and a short loop on the Debug build" run_sanitized debug "$debug_tests"
  phase "Short fuzzing" fuzz_shortly
  results+=("$DDM_WS/debug/build")
}

main() {
  pattern=.
  parse_arguments "$@"
  # The last line is a verdict even if no test could run.
  trap '[[ $? == 0 || -n ${reported:-} ]] || echo "0 passed, 1 failed"
    [[ -z ${debug_build:-} ]] || kill -- "-$debug_build" 2>/dev/null || true' EXIT
  use_system_environment
  # The path must be absolute, because tests run in their own folders.
  [[ -z ${DDM_PILCO_VECTORS:-} ]] || DDM_PILCO_VECTORS=$(realpath -m -- "$DDM_PILCO_VECTORS")
  check_system
  ensure_localhost_resolves
  make_workspace
  phase "Packages" install_packages "${packages_to_run[@]}" "${packages_to_test[@]}"
  install_by_rosdep
  if [[ $mode == fuzz ]]; then
    phase "Debug build of the fuzz targets into $DDM_WS/debug/devel" build_sanitized debug fuzz_targets
    reported=yes
    run_fuzzing "$(realpath -m -- "$2")" "${3:-100000}" 0
    return
  fi
  run_mode
  reported=yes
  say "Result ($SECONDS s after the start)"
  /usr/bin/python3 "$checkout/ddm_launch/qa/test_report.py" "${results[@]}"
}

# If a test sources this file, only the functions are defined.
[[ ${BASH_SOURCE[0]} != "$0" ]] || main "$@"
