# Times what users wait for, in one table.
# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import statistics
import tempfile

from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, find_program, package_path, processor, program_parser, run_program
from ddm_launch.settings import read_yaml
from ddm_launch.tables import write_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import Programs

LOOPS = ("lockstep", "bare")
COLUMNS = ["name", "median_us", "p99_us"]
BUDGET_COLUMNS = ["preset", "load", "budget_ms", "plans", "cut_short", "median_ms", "p99_ms", "p999_ms", "max_ms",
                  "within_2_ms", "within_10_ms"]
TRIALS, SEEDS, RESTARTS, NUM_FRAMES, NUM_PLANS = 15, 10, 9, 10000, 2000

ABOUT = """\
Times objective and gradient, one retraining, PCA, encoding, plans, renderer and bag reading on the 1600 frames of an
experiment that it runs first; the experiment itself, in one process and with the nodes; and the lock-step loop next to
two nodes that only send the same messages to and fro. Starts what it needs, a master too. Everything runs on one core where
it can; the machine should have nothing else to do."""

EPILOG = """\
DIR/speed.csv, one row a name; times in microseconds, of single calls unless said otherwise:
  objective_gradient   V_R + V_P and its gradient, float32, 1600 frames
  matrix_products/N    the matrix products of the same and nothing else, N samples at a time
  matrix_products      the same in their best blocking
  retrain              a retraining of 200 iterations on 1600 frames, PCA included
  pca, encode          PCA of 1601 images; the features of one image
  plan                 a whole plan along greedy trials; plan_cost_gradient: one evaluation of its cost
  render, read_bag     an image of the simulator; a bag of 100 frames
  lockstep_round_trip  image to torque to next image with sim_node and mpc_node, random policy, recorder off: means over
                       0.1 s; median of the medians of 9 restarts
  bare_round_trip      the same messages between two nodes that do nothing with them, restarts taking turns
  ..._trip_one_core    all these processes, and the master, on one core
  experiment           15 trials after the random one in one process, the whole; once
  efficient_NAME       the same of the preset efficient, whose frames are 1600 too. efficient_experiment is the median of
                       the seeds 0 to 9; so is efficient_experiment_all_cores, the only row in which training may use
                       all cores
  ros_experiment       the same by roslaunch, from the first frame to the last; once
DIR/planning_budget.csv  2000 decisions of presets paper and efficient that would take minutes, with mpc/time_budget at
                       5 ms, on the idle machine and with a busy process on each core: time from when an image is due to
                       its torque, and the fraction that took at most the budget and 2 ms, or 10 ms
DIR/machine.yaml       processor, version, iterations of a plan"""


class Benchmark:
    def __init__(self, out, scratch):
        self.out, self.scratch = os.path.abspath(out), scratch
        self.programs = Programs(scratch)
        self.run = os.path.join(scratch, "experiment")
        self.rows = {}  # name: {column: [us]}
        self.wall_us = {}  # name: of each run
        self.plan_iterations = None
        self.budgets = []  # rows of planning_budget.csv

    def keep_wall_time(self, name, run):
        summary = read_yaml(os.path.join(run, "summary.yaml"))
        if summary.get("finished") is not True:
            raise Failure("%s: the experiment did not finish" % name)
        self.wall_us.setdefault(name, []).append(1e6 * summary["wall_s"])
        self.rows[name] = {"median_us": statistics.median(self.wall_us[name])}

    def experiment(self, name="experiment", preset="paper", seed=0, **variables):
        """Leaves the run of seed 0 in SCRATCH/NAME."""
        run = os.path.join(self.scratch, name + ("_%d" % seed if seed else ""))
        self.programs.call(name, [find_program("run_experiment"), "--preset", preset, "--plant", "pendulum", "--seed",
                                  str(seed), "--trials", str(TRIALS), "--out", run], **variables)
        self.keep_wall_time(name, run)

    def efficient(self, seed):
        self.experiment("efficient_experiment", "efficient", seed)
        self.experiment("efficient_experiment_all_cores", "efficient", seed, OMP_NUM_THREADS=str(os.cpu_count()))

    def ros_experiment(self):
        run = os.path.join(self.scratch, "ros_experiment")
        self.programs.roslaunch("ros_experiment", "ddm_launch", "experiment.launch", "preset:=paper",
                                "plant:=pendulum", "seed:=0", "trials:=%d" % TRIALS, "runs:=" + run)
        self.keep_wall_time("ros_experiment", run)

    def kernels(self, prefix=""):
        """Of the experiment of this prefix."""
        name = prefix + "kernels"
        report = os.path.join(self.scratch, name + ".json")
        self.programs.call(name, [find_program("speed_kernels"), os.path.join(self.scratch, prefix + "experiment"),
                                  "--benchmark_out_format=json", "--benchmark_out=" + report])
        with open(report) as stream:
            found = json.load(stream)["benchmarks"]
        times = {}  # name: {median, p99}
        for row in found:
            if row.get("error_occurred"):
                raise Failure("%s: %s: %s" % (name, row["name"], row.get("error_message", "failed")))
            kernel = row["run_name"].split("/iterations")[0]
            times.setdefault(kernel, {})[row.get("aggregate_name")] = row["real_time"]
            if not prefix and kernel == "plan" and row.get("aggregate_name") == "mean":
                self.plan_iterations = row["plan_iterations"]
        times["matrix_products"] = min((found for name, found in times.items() if name.startswith("matrix_products/")),
                                       key=lambda found: found["median"])
        for kernel, found in times.items():
            self.rows[prefix + kernel] = {"median_us": found["median"], "p99_us": found["p99"]}

    def round_trips(self, progress):
        """Restarts of both loops, on all cores and on one, taking turns."""
        all_cores = os.sched_getaffinity(0)
        cores = {"": all_cores, "_one_core": {min(all_cores)}}
        times = {loop + "_round_trip" + suffix: [] for suffix in cores for loop in LOOPS}
        for _ in range(RESTARTS):
            for suffix, chosen in cores.items():
                for loop in LOOPS:
                    os.sched_setaffinity(0, chosen)  # what is started from here on inherits it
                    try:
                        times[loop + "_round_trip" + suffix].append(self.round_trip_us(loop))
                    finally:
                        os.sched_setaffinity(0, all_cores)
                    progress.update(1)
        for name, medians in times.items():
            self.rows[name] = {"median_us": statistics.median(medians)}

    def round_trip_us(self, loop):
        """Median of one start of one of LOOPS."""
        path = os.path.join(tempfile.mkdtemp(dir=self.scratch), "round_trip.yaml")
        output = self.programs.roslaunch(loop, package_path("qa", "benchmark", loop + ".launch"), "out:=" + path,
                                         "num_frames:=%d" % NUM_FRAMES)
        measured = read_yaml(path)
        if not measured:
            raise Failure("%s: the nodes ended without a result. Their last words:\n%s" % (loop, output[-2000:].strip()))
        return measured["median_us"]

    def planning_budget(self):
        for load in ([], ["--busy"]):
            for preset in ("paper", "efficient"):
                row = self.programs.call("planning_budget", [find_program("planning_budget"), "--preset", preset,
                                                             "--plans", str(NUM_PLANS)] + load)
                self.budgets.append(row.strip().split(","))

    def work(self):
        steps = [("experiment", self.experiment), ("kernels", self.kernels)]
        steps += [("efficient, seed %d" % seed, lambda seed=seed: self.efficient(seed)) for seed in range(SEEDS)]
        steps.append(("kernels of efficient", lambda: self.kernels("efficient_")))
        steps += [("planning with a budget", self.planning_budget), ("roslaunch experiment", self.ros_experiment)]
        with tqdm(total=len(steps) + 2 * len(LOOPS) * RESTARTS, unit="step", dynamic_ncols=True, disable=None) as progress:
            for name, step in steps:
                progress.set_description(name)
                step()
                self.write()  # after each step: what was timed is kept if a later one fails
                progress.update(1)
            progress.set_description("lock-step and bare loop")
            self.round_trips(progress)
        self.write()

    def write(self):
        write_csv(os.path.join(self.out, "speed.csv"), COLUMNS,
                  [[name] + [float(row[column]) if column in row else "" for column in COLUMNS[1:]]
                   for name, row in self.rows.items()])
        write_csv(os.path.join(self.out, "planning_budget.csv"), BUDGET_COLUMNS, self.budgets)
        machine = {"cpu": processor(), "cores": os.cpu_count(), "plan_iterations": self.plan_iterations,
                   "version": read_yaml(os.path.join(self.run, "config.yaml")).get("version", "?")}
        write_file(os.path.join(self.out, "machine.yaml"), yaml.safe_dump(machine, sort_keys=False))


def main(arguments=None):
    parser = program_parser("benchmark", ABOUT, EPILOG)
    parser.add_argument("--out", default="speed", metavar="DIR", help="default speed")
    options = parser.parse_args(arguments)

    def work():
        with tempfile.TemporaryDirectory() as scratch:
            benchmark = Benchmark(options.out, scratch)
            benchmark.work()
        print("results: %s" % benchmark.out)
    return run_program("benchmark", work)
