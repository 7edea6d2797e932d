# benchmark: measures the computing times that users notice, and writes them into one table.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import json
import os
import statistics
import tempfile

from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, find_program, processor, program_parser, run_program
from ddm_launch.settings import read_yaml
from ddm_launch.tables import write_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import Process, free_port, on_this_machine, start_roslaunch

LOOPS = ("lockstep", "bare")
COLUMNS = ["name", "median_us", "p99_us"]
TRIALS, SEEDS, RESTARTS, NUM_FRAMES = 15, 10, 9, 10000
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
  plan                 a whole plan along greedy trials
  lockstep_round_trip  image to torque to next image with sim_node and mpc_node, random policy, recorder off: the mean of
                       a start, median of 9 starts
  bare_round_trip      the same messages between two nodes that do nothing with them, starts taking turns
  ..._trip_one_core    all these processes, and the master, on one core
  experiment           15 trials after the random one in one process, the whole; once
  efficient_NAME       the same of the preset efficient. efficient_experiment is the median of the seeds 0 to 9; so is
                       efficient_experiment_all_cores, the only row in which training may use all cores
  ros_experiment       the same by roslaunch, from the first image to the last; once
DIR/machine.yaml       processor, version, iterations of a plan"""


class Benchmark:
    """Measures all rows of speed.csv. out: folder for the results. scratch: temporary folder for the experiments."""

    def __init__(self, out, scratch):
        self.out, self.scratch = os.path.abspath(out), scratch
        self.rows = {}  # name: {column: time [us]}
        self.wall_us = {}  # name: times of all experiments [us]
        self.plan_iterations = None

    def call(self, program, *arguments, **variables):
        """Runs a program and returns its output. variables: environment variables. Raises Failure if the program
        fails."""
        process = Process([find_program(program), *arguments], on_this_machine(**dict(ONE_THREAD, **variables)))
        if process.waitForEnd(LIMIT_S) != 0:
            raise Failure("%s failed:\n%s" % (program, process.output[-2000:]))
        return process.output

    def keep_wall_time(self, name, run):
        """Records the time of an experiment in the row `name`. Raises Failure if the experiment did not finish."""
        summary = read_yaml(os.path.join(run, "summary.yaml"))
        if summary.get("finished") is not True:
            raise Failure("%s: the experiment did not finish" % name)
        self.wall_us.setdefault(name, []).append(1e6 * summary["wall_s"])
        self.rows[name] = {"median_us": statistics.median(self.wall_us[name])}

    def experiment(self, name="experiment", preset="paper", seed=0, threads=1):
        """Runs an experiment and records its time. The run folder of seed 0 is SCRATCH/NAME."""
        run = os.path.join(self.scratch, name + ("_%d" % seed if seed else ""))
        self.call("run_experiment", "--preset", preset, "--plant", "pendulum", "--seed", seed, "--trials", TRIALS, "--out", run,
                  OMP_NUM_THREADS=str(threads))
        self.keep_wall_time(name, run)

    def efficient(self, seed):
        self.experiment("efficient_experiment", "efficient", seed)
        self.experiment("efficient_experiment_all_cores", "efficient", seed, os.cpu_count())

    def ros_experiment(self):
        run = os.path.join(self.scratch, "ros_experiment")
        with start_roslaunch(self.scratch, "experiment.launch", "preset:=paper", "plant:=pendulum", "seed:=0",
                             "trials:=%d" % TRIALS, "runs:=" + run, variables=ONE_THREAD) as launch:
            launch.waitForEnd(LIMIT_S)
        self.keep_wall_time("ros_experiment", run)

    def kernels(self, prefix=""):
        """Measures the computing times on the experiment with this prefix."""
        report = os.path.join(self.scratch, "kernels.json")
        self.call("benchmark_kernels", os.path.join(self.scratch, prefix + "experiment"), "--benchmark_out_format=json",
                  "--benchmark_out=" + report)
        with open(report) as stream:
            found = json.load(stream)["benchmarks"]
        times = {}  # name: {statistic: time [us]}
        for row in found:
            if row.get("error_occurred"):
                raise Failure("%s: %s" % (row["name"], row.get("error_message", "failed")))
            kernel = row["run_name"].split("/iterations")[0]
            times.setdefault(kernel, {})[row.get("aggregate_name")] = row["real_time"]
            if not prefix and kernel == "plan" and row.get("aggregate_name") == "mean":
                self.plan_iterations = row["plan_iterations"]
        products = [found for name, found in times.items() if name.startswith("matrix_products/")]
        times["matrix_products"] = min(products, key=lambda found: found["median"])
        for kernel, found in times.items():
            self.rows[prefix + kernel] = {"median_us": found["median"], "p99_us": found["p99"]}

    def round_trips(self, progress):
        """Measures both loops RESTARTS times, alternately on all cores and on one core."""
        all_cores, times = os.sched_getaffinity(0), {}
        for _ in range(RESTARTS):
            for loop in LOOPS:
                for suffix, cores in (("", all_cores), ("_one_core", {min(all_cores)})):
                    os.sched_setaffinity(0, cores)  # child processes inherit the affinity
                    try:
                        times.setdefault(loop + "_round_trip" + suffix, []).append(self.round_trip_us(loop))
                    finally:
                        os.sched_setaffinity(0, all_cores)
                    progress.update(1)
        for name, means in times.items():
            self.rows[name] = {"median_us": statistics.median(means)}

    def round_trip_us(self, loop):
        """Starts one of LOOPS and returns the mean time of its round trips [us]."""
        port = free_port()
        master = dict(ONE_THREAD, ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOME=self.scratch)
        with contextlib.ExitStack() as running:
            if loop == "lockstep":
                nodes = running.enter_context(start_roslaunch(
                    self.scratch, "nodes.launch", "preset:=paper", "plant:=pendulum", "recorder:=false", "trainer:=false",
                    port=port, variables=ONE_THREAD))
                nodes.waitForText("process[mpc_node", 60.0)  # the node is started after all parameters are set
            else:
                for command in (["roscore", "-p", port], [find_program("benchmark_kernels"), "bare_controller"]):
                    running.enter_context(Process(command, on_this_machine(**master)))
            timed = {"lockstep": "lockstep", "bare": "bare_camera"}[loop]
            return float(self.call("benchmark_kernels", timed, NUM_FRAMES, **master).split()[-1])

    def work(self):
        steps = [("experiment", self.experiment), ("kernels", self.kernels)]
        steps += [("efficient, seed %d" % seed, lambda seed=seed: self.efficient(seed)) for seed in range(SEEDS)]
        steps.append(("kernels of efficient", lambda: self.kernels("efficient_")))
        steps.append(("roslaunch experiment", self.ros_experiment))
        with tqdm(total=len(steps) + 2 * len(LOOPS) * RESTARTS, unit="step", dynamic_ncols=True, disable=None) as progress:
            for name, step in steps + [("lock-step and bare loop", lambda: self.round_trips(progress))]:
                progress.set_description(name)
                step()
                self.write()  # after each step, so that a later failure loses no results
                progress.update(1)

    def write(self):
        write_csv(os.path.join(self.out, "speed.csv"), COLUMNS,
                  [[name] + [float(row[column]) if column in row else "" for column in COLUMNS[1:]]
                   for name, row in self.rows.items()])
        version = read_yaml(os.path.join(self.scratch, "experiment", "config.yaml")).get("version", "?")
        machine = {"cpu": processor(), "cores": os.cpu_count(), "plan_iterations": self.plan_iterations, "version": version}
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
