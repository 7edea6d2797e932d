# benchmark: measures the computing times that users notice, and writes them into one table.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import tempfile

import numpy as np
from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, find_program, program_parser, run_program
from ddm_launch.run_folder import read_table, read_yaml, write_table
from ddm_model.plain_file import write_file
from ddm_qa.processes import Process, free_port, on_this_machine, start_roslaunch

TRIALS, RESTARTS, NUM_FRAMES, RETRAININGS = 15, 9, 10000, 10
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
LIMIT_S = 900.0  # time limit of a program

ABOUT = """\
Times an experiment in one process; objective and gradient, one retraining and plans on its 1600 images; and the lock-step
loop of the nodes next to two nodes that only send the same messages to and fro. Starts what it needs, a master too. Training
uses one thread; the machine should have nothing else to do. `taskset -c 0` in front of the command puts everything on one
core."""

EPILOG = """\
DIR/speed.csv, one row a name; times in microseconds, of single calls unless said otherwise:
  experiment           15 trials after the random one in one process, the whole; once
  objective_gradient   V_R + V_P and its gradient, float32, 1600 images
  matrix_products/N    the matrix products of the same and nothing else, N samples at a time
  matrix_products      the same in their best blocking
  retrain              a retraining of 200 iterations on 1600 images, PCA included
  plan                 a whole plan along a greedy trial: median and 99 % quantile of a trial, median of 20 trials
  lockstep_round_trip  image to torque to next image with sim_node and mpc_node, random policy, recorder off: the mean of
                       a start, median of 9 starts
  bare_round_trip      the same messages between two nodes that do nothing with them, starts taking turns
DIR/machine.yaml       processor, version"""


def call(program, *arguments, package="ddm_launch", **variables):
    """Runs a program and returns its output. variables: environment variables. Raises Failure if the program fails."""
    process = Process([find_program(program, package), *arguments], on_this_machine(**dict(ONE_THREAD, **variables)))
    if process.waitForEnd(LIMIT_S) != 0:
        raise Failure("%s failed:\n%s" % (program, process.output[-2000:]))
    return process.output


def experiment(run, preset):
    call("run_experiment", "--preset", preset, "--plant", "pendulum", "--seed", 0, "--trials", TRIALS, "--out", run)
    yield "experiment", 1e6 * read_yaml(run, "summary.yaml")["wall_s"], None


def objective(run):
    rows = {}
    for line in call("benchmark_kernels", run).splitlines():
        name, median, p99 = line.split()
        rows[name] = (float(median), float(p99))
    rows["matrix_products"] = min(row for name, row in rows.items() if name.startswith("matrix_products/"))
    for name, row in rows.items():
        yield (name, *row)


def training_and_plan(run, scratch):
    bags = sorted(glob.glob(os.path.join(run, "trial_*", "trial.bag")))
    config, times = ["--config", os.path.join(run, "config.yaml")], []
    for _ in range(RETRAININGS):
        output = call("train_from_bags", *config, "--set", "training/max_iterations=200", "--set",
                      "training/function_tolerance=1.0e-30",  # always runs all iterations
                      "--out", os.path.join(scratch, "model.ddm"), *bags, package="ddm_model")
        times.append(1e6 * float(output.split("train_s: ")[1].split()[0]))
    yield "retrain", np.median(times), np.quantile(times, 0.99)
    last_model = os.path.join(os.path.dirname(bags[-1]), "model.ddm")
    call("evaluate", *config, "--model", last_model, "--seeds", "0:20", "--jobs", 1, "--out", scratch)
    columns = ["plan_ms_median", "plan_ms_p99"]
    yield ("plan", *(1e3 * read_table(os.path.join(scratch, "evaluation.csv"), *columns)[columns].median()))


def round_trips(scratch):
    """Measures both loops RESTARTS times, alternately, and yields their rows."""
    means = {"lockstep": [], "bare_camera": []}
    for _ in range(RESTARTS):
        port = free_port()
        master = {"ROS_MASTER_URI": "http://localhost:%d" % port, "ROS_HOME": scratch}
        environment = on_this_machine(**master, **ONE_THREAD)

        def measure(role):  # while all other nodes of the loop are running
            means[role].append(float(call("benchmark_kernels", role, NUM_FRAMES, **master).split()[-1]))

        with start_roslaunch(scratch, "nodes.launch", "preset:=paper", "plant:=pendulum", "recorder:=false", "trainer:=false",
                             port=port, variables=ONE_THREAD) as nodes:
            nodes.waitForText("process[mpc_node", 60.0)  # the node is started after all parameters are set
            measure("lockstep")
        with Process(["roscore", "-p", port], environment), \
                Process([find_program("benchmark_kernels"), "bare_controller"], environment):
            measure("bare_camera")
    for name, role in (("lockstep_round_trip", "lockstep"), ("bare_round_trip", "bare_camera")):
        yield name, np.median(means[role]), None


def work(out, preset):
    """Writes the tables after each step, so that a later failure loses no results."""
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        run = os.path.join(scratch, "run")
        steps = (experiment(run, preset), objective(run), training_and_plan(run, scratch), round_trips(scratch))
        for step in tqdm(steps, unit="step", dynamic_ncols=True, disable=None):
            rows += step
            write_table(os.path.join(out, "speed.csv"), rows, ["name", "median_us", "p99_us"])
        version = read_yaml(run, "config.yaml")["version"]
    with open("/proc/cpuinfo") as stream:  # family and model distinguish generations of processors with the same name
        machine = dict(re.findall(r"^(model name|cpu family|model)\s*: (.*)$", stream.read(), re.MULTILINE))
    machine.update(cores=len(os.sched_getaffinity(0)), version=version)
    write_file(os.path.join(out, "machine.yaml"), yaml.safe_dump(machine, sort_keys=False))
    print("results: %s" % out)


def main():
    parser = program_parser("benchmark", ABOUT, EPILOG)
    parser.add_argument("--out", default="speed", metavar="DIR", help="default %(default)s")
    parser.add_argument("--preset", default="paper", help="of the experiment; default %(default)s")
    options = parser.parse_args()
    return run_program("benchmark", lambda: work(os.path.abspath(options.out), options.preset))
