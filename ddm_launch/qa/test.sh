#!/usr/bin/env bash
# Installs, builds Release and Debug, runs every test, and closes with the line "N passed, N failed".
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/workspace.sh"
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
. "$(dirname "${BASH_SOURCE[0]}")/sanitized.sh"

usage() {
  cat <<TEXT
usage: bash test.sh [-R PATTERN | --debug | --thread-sanitizer]

Installs the packages that are missing (as root, or through sudo), builds the workspace \$DDM_WS, and
runs every test: gtest, rosunit, rostest, roslaunch-check and the linters on the Release build; the gtests of the core
once more, a short experiment and short fuzzing on a Debug build by clang, with Eigen's assertions, AddressSanitizer,
UndefinedBehaviorSanitizer, and warnings as errors. A case that runs in several builds counts once; one that is
skipped does not count and is named. Returns 1 if any case fails, if a test leaves no result, or if a sanitizer
reports anything.

  -R PATTERN          instead of all that: the Release build, and the tests whose names match this regular expression,
                      for example -R 'python_film|ddm_mpc_test'
  --debug             instead of all that: the Debug build of everything, and all gtests on it
  --thread-sanitizer  instead of all that: what has several threads, on a Debug build with ThreadSanitizer
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

parse_arguments() {
  (($# == 0)) && return
  [[ $1 == --help || $1 == -h ]] && usage && exit 0
  [[ $1 == -R && $# == 2 ]] && builds=(part) && pattern=$2 && return
  [[ $1 == --debug && $# == 1 ]] && builds=(all_debug) && return
  [[ $1 == --thread-sanitizer && $# == 1 ]] && builds=(thread) && return
  printf 'test.sh: unknown argument %s\n\n' "'$1'" >&2
  usage >&2
  exit 2
}

# Runs the tests of a build folder whose names match, as many at a time as there are cores; CMake knows which must be
# alone. What failed is told by the results.
run_tests() {  # BUILD_FOLDER PATTERN
  cd "$1" || return
  rm -rf test_results/* tests_declared.json Testing/TAG  # results of an earlier call must not count
  ctest -R "$2" --show-only=json-v1 >tests_declared.json
  : >DartConfiguration.tcl  # -T asks for this file, whose settings are all optional
  ctest -T Test -j "$(nproc)" -R "$2" --output-on-failure --timeout 600 </dev/null && return
  # what failed, now and not only when the other builds are done
  /usr/bin/python3 "$checkout/ddm_launch/qa/test_report.py" "$1" | grep -A 40 '^FAILED' || true
}

# What is built and run; each gives a build folder to the report. The Debug build makes what it runs.
builds=(release debug)
debug_targets=("${loop_programs[@]}" "${gtest_programs[@]}" fuzz_targets)
debug_tests="_gtest_($(IFS='|' && echo "${gtest_programs[*]}"))\$"
run_build() {  # release|part|debug|all_debug|thread
  case $1 in
    part)
      phase "Release build into $DDM_WS/devel" build_release all tests
      phase "Tests on the Release build" run_tests "$DDM_WS/build" "$pattern"
      results+=("$DDM_WS/build")
      ;;
    release)
      phase "Release build into $DDM_WS/devel" build_release all tests
      # most tests wait for something, so the next build takes the processor time that they leave
      start_debug_build
      phase "Tests on the Release build" run_tests "$DDM_WS/build" .
      results+=("$DDM_WS/build")
      ;;
    debug)
      phase "Debug build with AddressSanitizer into $DDM_WS/debug/devel" finish_debug_build
      run_debug "$debug_tests"
      ;;
    all_debug)
      phase "Debug build of everything into $DDM_WS/debug/devel" build_sanitized address -DDDM_PILCO=ON all tests fuzz_targets
      run_debug _gtest_
      ;;
    thread)
      phase "Build with ThreadSanitizer into $DDM_WS/thread/devel" \
        build_sanitized thread "${loop_programs[@]}" "${threaded_programs[@]}"
      phase "Tests of threads and a short loop with ThreadSanitizer" run_sanitized thread "$threaded_tests"
      results+=("$DDM_WS/thread/build")
      ;;
  esac
}

run_debug() {  # PATTERN
  phase "gtests and a short loop on the Debug build" run_sanitized address "$1"
  phase "Short fuzzing" fuzz_shortly
  results+=("$DDM_WS/debug/build")
}

# Builds in a session of its own, whose processes run only where all others leave a core idle.
start_debug_build() {
  mkdir -p "$DDM_WS/debug"
  rm -f "$DDM_WS/debug/build.code"
  : >"$DDM_WS/debug/build.log"  # there before anybody follows it
  export checkout
  setsid bash -c "$(declare -p unity_flags debug_targets && declare -f)"'
    lower_priority
    code=0
    build_sanitized address "${debug_targets[@]}" || code=$?
    echo "$code" >"$DDM_WS/debug/build.code"' >"$DDM_WS/debug/build.log" 2>&1 </dev/null &
  debug_build=$!
}

lower_priority() {
  renice -n 19 "$$" >/dev/null || true
  # Linux shares the cores between sessions first, by a niceness of their own
  { echo 19 >"/proc/$$/autogroup"; } 2>/dev/null || true
}

finish_debug_build() {
  local code
  tail --pid="$debug_build" -n 1 -f "$DDM_WS/debug/build.log"
  code=$(cat "$DDM_WS/debug/build.code")
  ((code == 0)) || cat "$DDM_WS/debug/build.log"
  return "$code"
}

results=()
durations=()
phase() {  # TITLE COMMAND...
  local title=$1 start=$SECONDS code=0
  shift
  say "$title"
  ("$@") || code=$?
  durations+=("$(printf '%5d s  %s' $((SECONDS - start)) "$title")")
  ((code == 0)) || fail "$title: failed with code $code. Remedy: see the first error above."
}

main() {
  parse_arguments "$@"
  # the verdict is the last line, also when no test could be run
  trap '[[ $? == 0 || -n ${reported:-} ]] || echo "0 passed, 1 failed"
    [[ -z ${debug_build:-} ]] || kill -- "-$debug_build" 2>/dev/null || true' EXIT
  use_system_environment
  # tests run in folders of their own
  [[ -z ${DDM_PILCO_VECTORS:-} ]] || DDM_PILCO_VECTORS=$(realpath -m -- "$DDM_PILCO_VECTORS")
  check_system
  ensure_localhost_resolves
  make_workspace
  phase "Packages" install_packages "${packages_to_run[@]}" "${packages_to_test[@]}"
  install_by_rosdep
  local build
  for build in "${builds[@]}"; do run_build "$build"; done
  say "Time"
  printf '%s\n' "${durations[@]}"
  reported=yes
  say "Result"
  /usr/bin/python3 "$checkout/ddm_launch/qa/test_report.py" "${results[@]}"
}

main "$@"
