# The commands of the pages: which there are, which test runs each, and how they become cheap.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re

import pages

# Programs and launch files that page_commands_test runs as the page says, but for CHEAPER.
RUN_HERE = {"run_experiment", "sweep", "feature_space", "study_figure pendulum_feature_space", "figure film",
            "figure film_strip", "figure learning_curve", "figure success_rate", "evaluate", "train_from_bags", "inspect",
            "export", "new_plant", "simulate", "sim_node", "mpc_node", "experiment.launch", "record.launch",
            "control.launch", "replay.launch", "demo.sh"}

# Those that another test runs, with all that takes long or needs more than one machine: the test must name it.
ELSEWHERE = {"reproduce_paper": "reproduce_paper_test.py", "reproduce_efficient": "reproduce_efficient_test.py",
             "benchmark": "benchmark_programs_test.py", "planning_budget": "benchmark_programs_test.py",
             "growth": "benchmark_programs_test.py", "fault_table": "fault_table_test.py", "soak": "soak_test.py",
             "rviz_screenshot": "rviz_test.py", "task_diagnosis": "task_diagnosis_test.py",
             "compare_results": "compare_results_test.py",
             "robot.launch": "robot_loop_test.py", "robot_check.launch": "robot_loop_test.py",
             "part.launch": "several_machines_test.py", "test.sh": "scripts_test.py",
             "read_bags": "reading_test.py"}

# Whole commands that another test runs: its words for them.
COMMANDS_ELSEWHERE = [
    (r"ddm_cart|cart_ws", "own_plant_test.py", "catkin_make"),
    (r"simulator_here:=false", "several_machines_test.py", "simulator_here:=false"),
    (r"export ROS_(MASTER_URI|IP)=", "several_machines_test.py", "ROS_IP"),
    (r"rosservice call /take_goal", "robot_reset_test.py", "take_goal"),
    (r"rosservice call /enable", "robot_motor_test.py", "enable"),
    (r"--method pilco_state", "pilco_test.py", "pilco_state"),
    (r"effort:=/rehearsal", "robot_loop_test.py", "effort:=/rehearsal"),
    (r"rostopic echo /rehearsal", "robot_loop_test.py", "/rehearsal"),
    (r"replay.launch .*my_robot/", "robot_loop_test.py", "replay.launch"),
    (r"my_robot/", "robot_loop_test.py", "robot.launch"),  # what a robot has left
    (r"/install/setup.bash", "install_test.py", "setup.bash")]

# Run by no test.
NOT_RUN = {r"^perf (record|report)": "a profiler, which needs rights on the kernel",
           r"qa/fuzz\.sh": "hours of random input; test.sh gives each target some seconds of it",
           r"image_transport republish": "a program of another package, which needs a camera that compresses"}

# The same programs and options, less work. What is left out here has a test of its own: reproduce_paper_test, rviz_test.
CHEAPER = [
    (r"preset:=\w+", "preset:=debug"), (r"--preset \w+", "--preset debug"), (r"presets/\w+", "presets/debug"),
    (r"(run_experiment)(?!.*--preset)", r"\1 --preset debug"), (r"(run_experiment)(?!.*--trials)", r"\1 --trials 1"),
    (r"((?:experiment|record|control|replay)\.launch)(?!.*preset:=)", r"\1 preset:=debug"),
    (r"(experiment\.launch)(?!.*trials:=)", r"\1 trials:=1"),
    (r"--trials \d+", "--trials 1"), (r"trials:=\d+", "trials:=1"), (r"--seeds \d+:\d+", "--seeds 0:2"),
    (r"(--method oracle --config .*)", r"\1 --config %s/ddm_launch/config/presets/debug.yaml" % pages.CHECKOUT),
    (r"(feature_space .*--trial) \d+", r"\1 1"), (r"trial_\d+/model.ddm", "trial_001/model.ddm"),
    (r"/evaluation_\d+", "/evaluation_001"), (r"rviz:=true", "view:=true frame_rate:=0"),
    (r"^bash ddm_launch/scripts/demo.sh", "bash -c 'set -e; . %s/ddm_launch/scripts/demo.sh; "
     "check_system() { :; }; install_packages() { :; }; build_release() { :; }; main \"$@\"' demo.sh --trials 1"
     % pages.CHECKOUT)]

# Commands that do not end: what runs, and when the next one may come.
STAYS = {"roscore &": ("roscore -p ${ROS_MASTER_URI##*:}", "rosparam get /rosversion"),
         "rosrun ddm_sim sim_node &": ("rosrun ddm_sim sim_node", "rosservice type /reset"),
         "rosrun ddm_mpc mpc_node &": ("rosrun ddm_mpc mpc_node", "rosservice type /mpc_node/mpc/set_parameters")}

# roslaunch returns 0 whatever happened: its main node must have ended well, and said so.
PREAMBLE = """set -e
trap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT
roslaunch() {
  command roslaunch "$@" 2>&1 | tee ~/launch.log
  grep -q 'process has finished cleanly' ~/launch.log && ! grep -q 'exit code' ~/launch.log
}
"""

COMMAND = re.compile(r"^(rosrun|roslaunch|bash|catkin_make|catkin|perf) \S")


def without_comment(line):
    return re.sub(r"\s+#\s.*$", "", line).strip()


def block_commands(text):
    """Commands in blocks of bash, and those behind a $ in blocks that show what a program says."""
    out = []
    for block in pages.blocks(text, "bash"):
        out += [without_comment(line) for line in re.sub(r"\s*\\\n\s*", " ", block).splitlines()]
    for block in pages.blocks(text, ""):
        out += [line[2:] for line in block.splitlines() if line.startswith("$ ")]
    return [command for command in out if command]


def usage_commands(text):
    """Commands in running text and in blocks that show a usage: only their names and options can be looked at."""
    lines = [line for block in pages.blocks(text, "") for line in block.splitlines()]
    return [command for command in pages.code_spans(pages.without_blocks(text)) + lines if COMMAND.match(command)]


def program_of(command):
    """Name of the program or launch file that a command starts, or None for one of the shell."""
    found = re.search(r"\b(?:rosrun|roslaunch(?: --wait)?|catkin_find --libexec) \w+ ((?:study_)?figure \w+|\w[\w.]*)|"
                      r"(?:scripts|qa)/(\w+\.sh)", command)
    return found and (found.group(1) or found.group(2))


def test_elsewhere(command):
    """(file, word) of the test that runs a command, or None."""
    for pattern, test, word in COMMANDS_ELSEWHERE:
        if re.search(pattern, command):
            return test, word
    program = program_of(command)
    return (ELSEWHERE[program], program) if program in ELSEWHERE else None


def is_run_by_nobody(command):
    return any(re.search(pattern, command) for pattern in NOT_RUN)


def cheaper(command):
    for pattern, replacement in CHEAPER:
        command = re.sub(pattern, replacement, command)
    return command


def script_of(text):
    """All commands of a page that are run here, as a script of bash that ends at the first one that fails."""
    lines = []
    for command in block_commands(text):
        if test_elsewhere(command) or is_run_by_nobody(command):
            continue
        quoted = command.replace("'", "'\\''")
        lines.append("printf '%%s\\n' '$ %s'" % quoted)
        if command in STAYS:
            lines.append("%s &\nuntil %s >/dev/null 2>&1; do sleep 0.1; done" % STAYS[command])
        else:
            lines.append(cheaper(command))
    return PREAMBLE + "\n".join(lines) + "\n"


def test_path(test):
    """Of a test of this package, or of the robot side in ddm_sim."""
    paths = [os.path.join(pages.CHECKOUT, package, "test", test) for package in ("ddm_launch", "ddm_sim")]
    return next(path for path in paths if os.path.isfile(path))
