# benchmark: measures the computing times that users notice, and writes them into one table.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import json
import os
import tempfile

import numpy as np
from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, find_program, processor, program_parser, run_program
from ddm_launch.settings import read_yaml
from ddm_launch.tables import read_table, write_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import Process, free_port, on_this_machine, start_roslaunch

TRIALS, SEEDS, RESTARTS, NUM_FRAMES, RETRAININGS = 15, 10, 9, 10000, 10
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
LIMIT_S = 900.0  # time limit of a program

ABOUT = """\
Times objective and gradient, one retraining and plans on the 1600 images of an experiment that it runs first; the
experiment itself, in one process and with the nodes; and the lock-step loop next to
two nodes that only send the same messages to and fro. Starts what it needs, a master too. Everything runs on one core where
it can; the machine should have nothing else to do."""

EPILOG = """\
DIR/speed.csv, one row a name; times in microseconds, of single calls unless said otherwise:
  objective_gradient   V_R + V_P and its gradient, float32, 1600 images
  matrix_products/N    the matrix products of the same and nothing else, N samples at a time
  matrix_products      the same in their best blocking
  retrain              a retraining of 200 iterations on 1600 images, PCA included
  plan                 a whole plan along a greedy trial: median and 99 % quantile of a trial, median of 20 trials
  lockstep_round_trip  image to torque to next image with sim_node and mpc_node, random policy, recorder off: the mean of
                       a start, median of 9 starts
  bare_round_trip      the same messages between two nodes that do nothing with them, starts taking turns
  ..._trip_one_core    all these processes, and the master, on one core
  experiment           15 trials after the random one in one process, the whole; once
  efficient_NAME       the same of the preset efficient. efficient_experiment is the median of the seeds 0 to 9; so is
                       efficient_experiment_all_cores, the only row in which training may use all cores
  ros_experiment       the same by roslaunch, from the first image to the last; once
DIR/machine.yaml       processor, version"""


def call(program, *arguments, package="ddm_launch", **variables):
    """Runs a program and returns its output. variables: environment variables. Raises Failure if the program fails."""
    process = Process([find_program(program, package), *arguments], on_this_machine(**dict(ONE_THREAD, **variables)))
    if process.waitForEnd(LIMIT_S) != 0:
        raise Failure("%s failed:\n%s" % (program, process.output[-2000:]))
    return process.output


class Benchmark:
    """Measures all rows of speed.csv. out: folder for the results. scratch: temporary folder for the experiments."""

    def __init__(self, out, scratch):
        self.out, self.scratch = os.path.abspath(out), scratch
        self.rows = {}  # name: (median, 99 % quantile or "") [us]

    def add(self, name, times_us):
        """Adds the row of a name with the median of these times."""
        self.rows[name] = (float(np.median(times_us)), "")

    def wall_us(self, run):
        """Time of an experiment [us]. Raises Failure if it did not finish."""
        summary = read_yaml(os.path.join(run, "summary.yaml"))
        if summary.get("finished") is not True:
            raise Failure("%s: the experiment did not finish" % run)
        return 1e6 * summary["wall_s"]

    def experiments(self, name, preset="paper", seeds=1, threads=1):
        """Runs an experiment for each seed. The run folder of a seed is SCRATCH/NAME_SEED."""
        times = []
        for seed in range(seeds):
            run = os.path.join(self.scratch, "%s_%d" % (name, seed))
            call("run_experiment", "--preset", preset, "--plant", "pendulum", "--seed", seed, "--trials", TRIALS, "--out", run,
                 OMP_NUM_THREADS=str(threads))
            times.append(self.wall_us(run))
        self.add(name, times)

    def ros_experiment(self):
        run = os.path.join(self.scratch, "ros_experiment")
        with start_roslaunch(self.scratch, "experiment.launch", "preset:=paper", "plant:=pendulum", "seed:=0",
                             "trials:=%d" % TRIALS, "runs:=" + run, variables=ONE_THREAD) as launch:
            launch.waitForEnd(LIMIT_S)
        self.add("ros_experiment", [self.wall_us(run)])

    def parts(self, prefix=""):
        """Measures the parts of the experiment with this prefix."""
        run = os.path.join(self.scratch, prefix + "experiment_0")
        self.objective(prefix, run)
        bags = sorted(glob.glob(os.path.join(run, "trial_*", "trial.bag")))
        config = ["--config", os.path.join(run, "config.yaml")]
        times = []
        for _ in range(RETRAININGS):
            output = call("train_from_bags", *config, "--set", "training/max_iterations=200", "--set",
                          "training/function_tolerance=1.0e-30",  # always runs all iterations
                          "--out", os.path.join(self.scratch, "model.ddm"), *bags, package="ddm_model")
            times.append(1e6 * float(output.split("train_s: ")[1].split()[0]))
        self.rows[prefix + "retrain"] = (float(np.median(times)), float(np.quantile(times, 0.99)))
        last_model = os.path.join(os.path.dirname(bags[-1]), "model.ddm")
        call("evaluate", *config, "--model", last_model, "--seeds", "0:20", "--jobs", 1, "--out", self.scratch)
        columns = ["plan_ms_median", "plan_ms_p99"]
        plans = read_table(os.path.join(self.scratch, "evaluation.csv"), *columns)[columns].median()
        self.rows[prefix + "plan"] = tuple(1e3 * plans)

    def objective(self, prefix, run):
        report = os.path.join(self.scratch, "kernels.json")
        call("benchmark_kernels", run, "--benchmark_out_format=json", "--benchmark_out=" + report)
        with open(report) as stream:
            found = json.load(stream)["benchmarks"]
        times = {(row["run_name"].split("/iterations")[0], row["aggregate_name"]): row["real_time"] for row in found}
        rows = {name: (times[name, "median"], times[name, "p99"]) for name, _ in times}
        rows["matrix_products"] = min(row for name, row in rows.items() if name.startswith("matrix_products/"))
        self.rows.update((prefix + name, row) for name, row in rows.items())

    def round_trips(self):
        """Measures both loops RESTARTS times, alternately on all cores and on one core."""
        all_cores, times = os.sched_getaffinity(0), {}
        for _ in range(RESTARTS):
            for name, measure in (("lockstep_round_trip", self.lockstep_us), ("bare_round_trip", self.bare_us)):
                for suffix, cores in (("", all_cores), ("_one_core", {min(all_cores)})):
                    os.sched_setaffinity(0, cores)  # child processes inherit the affinity
                    try:
                        times.setdefault(name + suffix, []).append(measure(free_port()))
                    finally:
                        os.sched_setaffinity(0, all_cores)
        for name, means in times.items():
            self.add(name, means)

    def timed_us(self, role, port):
        """Mean time of the round trips of a loop whose other nodes are running [us]."""
        master = {"ROS_MASTER_URI": "http://localhost:%d" % port, "ROS_HOME": self.scratch}
        return float(call("benchmark_kernels", role, NUM_FRAMES, **master).split()[-1])

    def lockstep_us(self, port):
        with start_roslaunch(self.scratch, "nodes.launch", "preset:=paper", "plant:=pendulum", "recorder:=false",
                             "trainer:=false", port=port, variables=ONE_THREAD) as nodes:
            nodes.waitForText("process[mpc_node", 60.0)  # the node is started after all parameters are set
            return self.timed_us("lockstep", port)

    def bare_us(self, port):
        environment = on_this_machine(ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOME=self.scratch, **ONE_THREAD)
        with Process(["roscore", "-p", port], environment), \
                Process([find_program("benchmark_kernels"), "bare_controller"], environment):
            return self.timed_us("bare_camera", port)

    def work(self):
        steps = {"experiment": lambda: self.experiments("experiment"), "parts": self.parts,
                 "efficient": lambda: self.experiments("efficient_experiment", "efficient", SEEDS),
                 "efficient on all cores": lambda: self.experiments("efficient_experiment_all_cores", "efficient", SEEDS,
                                                                    os.cpu_count()),
                 "parts of efficient": lambda: self.parts("efficient_"), "roslaunch experiment": self.ros_experiment,
                 "lock-step and bare loop": self.round_trips}
        for name, step in tqdm(steps.items(), unit="step", dynamic_ncols=True, disable=None):
            tqdm.write(name)
            step()
            self.write()  # after each step, so that a later failure loses no results

    def write(self):
        write_csv(os.path.join(self.out, "speed.csv"), ["name", "median_us", "p99_us"],
                  [[name, *row] for name, row in self.rows.items()])
        version = read_yaml(os.path.join(self.scratch, "experiment_0", "config.yaml")).get("version", "?")
        machine = {"cpu": processor(), "cores": os.cpu_count(), "version": version}
        write_file(os.path.join(self.out, "machine.yaml"), yaml.safe_dump(machine, sort_keys=False))


def main():
    parser = program_parser("benchmark", ABOUT, EPILOG)
    parser.add_argument("--out", default="speed", metavar="DIR", help="default speed")
    options = parser.parse_args()

    def work():
        with tempfile.TemporaryDirectory() as scratch:
            Benchmark(options.out, scratch).work()
        print("results: %s" % os.path.abspath(options.out))
    return run_program("benchmark", work)
