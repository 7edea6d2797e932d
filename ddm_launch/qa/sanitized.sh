# Debug builds with the sanitizers of clang, and what runs on them. Sourced by test.sh, after workspace.sh.
# SPDX-License-Identifier: BSD-3-Clause

loop_programs=(resolve sim_node mpc_node view_node trial_recorder model_node experiment_node run_experiment evaluate)
threaded_programs=(
  model_node_test mpc_node_stop_test mpc_node_test refused_params_test replay_node robot_node train_from_bags trial_recorder_test
)
# What computes and what reads bytes from outside; `test.sh --debug` adds the other gtests, which take long to compile.
gtest_programs=(
  ddm_bag_io_test ddm_files_test ddm_images_test ddm_model_config_test ddm_model_test ddm_mpc_test ddm_msgs_test
  ddm_node_test ddm_params_test ddm_random_test ddm_robot_test
)
threaded_tests='^_ctest_ddm_[a-z]+_rostest_test_(model_node|mpc_node|replay|robot_node|trial_recorder)\.test$'

# Where the build with a sanitizer is. Argument: address or thread, as for DDM_SANITIZE.
sanitized_folder() {
  case $1 in
    address) echo "$DDM_WS/debug" ;;
    thread) echo "$DDM_WS/thread" ;;
  esac
}

# Portable instruction set, because reports shall be the same on all machines; -O1, because Eigen without any
# optimisation takes minutes for what Release does in seconds.
build_sanitized() {  # address|thread [-DDDM_PILCO=ON] TARGET...
  local folder jobs
  folder=$(sanitized_folder "$1")
  read -ra jobs < <(job_flags)
  make_devel_space "$folder/devel"
  catkin_make -C "$DDM_WS" --build "$folder/build" "${jobs[@]}" \
    -DCATKIN_DEVEL_PREFIX="$folder/devel" -DCMAKE_INSTALL_PREFIX="$folder/install" -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG='-O1 -gline-tables-only' -DDDM_AVX2=OFF -DDDM_WERROR=ON \
    -DDDM_SANITIZE="$1" -DDDM_PILCO=OFF "${unity_flags[@]}" "${@:2}"
}

# A short experiment by each driver and evaluations side by side. What does not reach its end is a report, too.
short_loop() {  # address|thread REPORTS
  local folder out
  folder=$(sanitized_folder "$1")
  out=$folder/loop
  rm -rf "$out"
  mkdir -p "$out"
  source_setup "$folder/devel/setup.bash"
  local port programs=$folder/devel/lib/ddm_launch
  port=$(PYTHONPATH=$PYTHONPATH:$checkout/ddm_launch/qa /usr/bin/python3 -c \
    'from ddm_qa.processes import free_port; print(free_port())')
  "$programs/run_experiment" --preset debug --trials 1 --out "$out/process" </dev/null >"$out/process.log" 2>&1 &&
    "$programs/evaluate" --preset debug --model "$out/process/trial_001/model.ddm" --seeds 0:8 --jobs 4 \
      --out "$out/evaluate" </dev/null >"$out/evaluate.log" 2>&1 || cat "$out"/*.log >"$2/one_process"
  timeout -s INT -k 30 300 roslaunch -p "$port" ddm_launch experiment.launch preset:=debug trials:=1 view:=true \
    runs:="$out/nodes" </dev/null >"$out/nodes.log" 2>&1 || true
  [[ -f $out/nodes/summary.yaml ]] || cp "$out/nodes.log" "$2/nodes"
}

# Runs tests and the loop; each file in build/sanitizer_reports is a report, which test_report.py takes for a failure.
run_sanitized() {  # address|thread PATTERN
  local reports suppressions=$checkout/ddm_launch/qa/thread_suppressions.txt
  reports=$(sanitized_folder "$1")/build/sanitizer_reports
  rm -rf "$reports"
  mkdir -p "$reports"
  export ASAN_OPTIONS=log_path=$reports/report:detect_stack_use_after_return=1:strict_string_checks=1
  export UBSAN_OPTIONS=log_path=$reports/report:print_stacktrace=1
  # ROS's own libraries are not instrumented: without the last option their locks look like none
  export TSAN_OPTIONS=log_path=$reports/report:suppressions=$suppressions:ignore_noninstrumented_modules=1
  # tells ThreadSanitizer what OpenMP, which is not instrumented either, does with threads
  [[ $1 != thread ]] || export OMP_TOOL_LIBRARIES="$(clang++ -print-resource-dir)/../../libarcher.so"
  short_loop "$1" "$reports"
  run_tests "$(sanitized_folder "$1")/build" "$2"
  if compgen -G "$reports/*" >/dev/null; then
    tail -n +1 "$reports"/*
  else
    echo "no report"
  fi
}

# Runs the fuzz targets; arguments are those of fuzz.sh.
run_fuzzing() {
  PYTHONPATH=$checkout/ddm_launch/src:$checkout/ddm_model/src /usr/bin/python3 "$checkout/ddm_launch/qa/scripts/fuzzing" \
    --programs "$(sanitized_folder address)/devel/lib" "$@"
}

# From the committed seeds on, always the same draws. A finding is told by the result file.
fuzz_shortly() {
  local out result
  out=$(sanitized_folder address)/fuzzing
  result=$(sanitized_folder address)/build/test_results/ddm_launch/fuzzing.xml
  rm -rf "$out" "$result"
  run_fuzzing --runs 1000 --seed 1 --out "$out" --junit "$result" || [[ -f $result ]]
}
