# Runs the paper's experiments and turns them into tables and figures, with one command.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import csv
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import time

import roslib.packages
from tqdm import tqdm
import yaml

from ddm_launch.paper_tables import SCHEDULES, write_csv, write_tables
from ddm_launch.run_folder import Evaluation, RunFolderError
from ddm_launch.sweep_folder import read_yaml

NUM_ANGLE_SEEDS = 16  # as in the paper's Fig. 7
NUM_PREDICTION_SEEDS = 20
FIGURE_SEED = 0  # which seed the figures of a single model show
FIGURE_STEP = 1
TRIALS = 15

ABOUT = """\
Reproduces the paper's experiments: success on the pendulum (Fig. 7 and 8) with the oracle and the other training
schedules beside it, predictions of the moving tile (Fig. 4 and 5) and of the pendulum, the feature space (Fig. 6),
tables and figures. The same command resumes."""

EPILOG = """\
in DIR:
  trials.csv, *.csv    rows of all seeds, and tables made from them; agreement.csv: what holds of the paper's claims
  *.png                figures
  SCHEDULE/, oracle/   trials.csv of the other schedules and of the oracle
  tile/, pendulum_predictions/
                       predictions.csv of each schedule
  machine.yaml         version of the code, processor, time and peak memory of each step
  runs/, logs/         everything that the programs left behind; not needed for the figures"""


class Failure(Exception):
    """A step failed; the message tells which and where to look."""


def program(name, package="ddm_launch"):
    found = roslib.packages.find_node(package, name)
    if not found:
        raise Failure("the program %s of %s is not there: build the workspace, then source its devel/setup.bash"
                      % (name, package))
    return found[0]


def package_path(*names):
    return os.path.join(roslib.packages.get_pkg_dir("ddm_launch"), *names)


class SweepStep:
    """Many seeds of one program; their rows end in TABLE."""

    def __init__(self, name, table, num_seeds, words, more=()):
        self.name, self.table, self.num_seeds, self.words, self.more = name, table, num_seeds, words, more

    def command(self, out, jobs):
        return ([program("sweep"), "--seeds", "0:%d" % self.num_seeds, "--out", self.folder(out)] + self.words +
                (["--jobs", str(jobs)] if jobs else []) + (["--"] + list(self.more) if self.more else []))

    def folder(self, out):
        return os.path.join(out, "runs", self.name)

    def seed_folder(self, out, seed):
        return os.path.join(self.folder(out), "seed_%04d" % seed)


def schedule_options(schedule):
    return [] if schedule == "joint" else ["--config", package_path("config", "schedules", schedule + ".yaml")]


def sweep_steps(preset, num_seeds):
    """All sweeps, the paper's own first."""
    pendulum = ["--preset", preset, "--plant", "pendulum", "--trials", str(TRIALS)]
    steps = [SweepStep("joint", "trials.csv", num_seeds, pendulum),
             SweepStep("oracle", "oracle/trials.csv", num_seeds, pendulum, ["--method", "oracle"])]
    for schedule in SCHEDULES[1:]:
        steps.append(SweepStep(schedule, schedule + "/trials.csv", num_seeds, pendulum, schedule_options(schedule)))
    for plant, folder in (("moving_tile", "tile"), ("pendulum", "pendulum_predictions")):
        for schedule in SCHEDULES:
            steps.append(SweepStep(
                "%s_%s" % (folder, schedule), "%s/%s/predictions.csv" % (folder, schedule),
                min(num_seeds, NUM_PREDICTION_SEEDS),
                ["--program", "prediction_experiment", "--preset", preset, "--plant", plant],
                schedule_options(schedule)))
    return steps


class Reproduction:
    def __init__(self, options):
        self.out, self.preset, self.jobs = os.path.abspath(options.out), options.preset, options.jobs
        self.steps = sweep_steps(options.preset, options.seeds)
        self.by_name = {step.name: step for step in self.steps}
        self.measured = {}  # step: {wall_s, peak_memory_mb}

    def path(self, *names):
        return os.path.join(self.out, *names)

    def run(self):
        os.makedirs(self.path("logs"), exist_ok=True)
        self.measured = read_yaml(self.path("machine.yaml")).get("steps") or {}
        total = sum(step.num_seeds for step in self.steps) + len(self.figure_commands()) + 1
        with tqdm(total=total, unit="step", dynamic_ncols=True, disable=None, smoothing=0.05) as bar:
            for step in self.steps:
                bar.set_description(step.name)
                self.run_sweep(step, bar)
                self.keep(os.path.join(step.folder(self.out), "sweep.csv"), step.table)
                self.write_machine()
            bar.set_description("tables")
            self.collect()
            agreement = write_tables(self.out, package_path("results", "published", "success_rate.csv"))
            bar.update(1)
            for name, command in self.figure_commands():
                bar.set_description(name)
                self.call(name, command)
                bar.update(1)
            bar.set_description("done")
        return agreement

    def keep(self, source, name):
        """Copies a result to where it is kept."""
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        shutil.copyfile(source, self.path(name))

    def run_sweep(self, step, bar):
        """Runs the seeds that are not finished, and moves the bar by each that is."""
        log = self.path("logs", step.name + ".log")
        start, finished = time.monotonic(), 0
        with open(log, "w") as stream:
            process = subprocess.Popen(step.command(self.out, self.jobs), stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            try:
                for line in process.stdout:
                    stream.write(line)
                    stream.flush()
                    to_run = re.search(r": (\d+) of \d+ seeds to run$", line.strip())
                    finished = step.num_seeds - int(to_run.group(1)) if to_run else finished
                    if to_run:
                        bar.update(finished)
                    elif re.match(r"seed \d+ finished", line):
                        finished += 1
                        bar.update(1)
            except BaseException:
                process.send_signal(signal.SIGINT)
                process.wait()
                raise
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
        if status != 0:
            raise Failure("%s: not all seeds are finished, see %s; the same command goes on" % (step.name, log))
        bar.update(step.num_seeds - finished)
        tqdm.write("%-36s %4d seeds  %6.1f s" % (step.name, step.num_seeds, time.monotonic() - start))
        if to_run_any(log):
            before = self.measured.get(step.name, {})
            self.measured[step.name] = {
                "seeds": step.num_seeds,
                "wall_s": round(before.get("wall_s", 0.0) + time.monotonic() - start, 1),
                "peak_memory_mb": round(max(before.get("peak_memory_mb", 0.0), usage.ru_maxrss / 1024.0), 1)}

    def call(self, name, command):
        log = self.path("logs", name + ".log")
        with open(log, "w") as stream:
            code = subprocess.call(command, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT)
        if code != 0:
            raise Failure("%s: '%s' failed with code %d, see %s" % (name, " ".join(command), code, log))

    def collect(self):
        """What the figures need of single runs."""
        joint = self.by_name["joint"]
        self.write_angles(joint)
        folder = joint.seed_folder(self.out, FIGURE_SEED)
        self.keep(os.path.join(folder, "config.yaml"), "config.yaml")
        self.keep(os.path.join(folder, "trial_%03d" % TRIALS, "model.ddm"), "pendulum/model.ddm")
        self.call("feature_space", [program("feature_space"), folder, "--trial", str(TRIALS), "--step",
                                    str(FIGURE_STEP), "--out", self.path("pendulum", "feature_space.csv")])
        for schedule in SCHEDULES[:2]:
            folder = self.by_name["tile_" + schedule].seed_folder(self.out, FIGURE_SEED)
            for name in ("config.yaml", "features.csv", "model.ddm", "strip.csv"):
                self.keep(os.path.join(folder, name), "tile/%s/%s" % (schedule, name))

    def write_angles(self, step):
        rows = []
        for seed in range(min(NUM_ANGLE_SEEDS, step.num_seeds)):
            for trial in range(1, TRIALS + 1):
                run = Evaluation(step.seed_folder(self.out, seed), trial)
                for k, (time_s, angle_rad) in enumerate(zip(run.time_s, run.angle_rad)):
                    rows.append((seed, trial, k, "%.3f" % time_s, "%.4f" % angle_rad))
        write_csv(self.path("angle_trajectories.csv"), ["seed", "trial", "step", "time_s", "angle_rad"], rows)

    def figure_commands(self):
        """(name, command) of each figure; all read nothing but what is kept."""
        def figure(name, *words):
            return name, [program(name)] + list(words) + ["--out", self.path(name + ".png")]
        return [
            figure("success_rate", "DDM + MPC=" + self.path("trials.csv"), "oracle=" + self.path("oracle/trials.csv"),
                   "--published", package_path("results", "published", "success_rate.csv")),
            figure("angle_trajectories", self.path("angle_trajectories.csv")),
            figure("pendulum_feature_space", self.path("pendulum", "feature_space.csv"), "--model",
                   self.path("pendulum", "model.ddm")),
            figure("prediction_strip", self.path("tile", "joint")),
            figure("feature_plane", self.path("tile", "joint"), self.path("tile", "sequential")),
            figure("schedules_compared", self.out)]

    def write_machine(self):
        """Where and with what the figures were made."""
        config = read_yaml(os.path.join(self.by_name["joint"].seed_folder(self.out, 0), "config.yaml"))
        machine = {"version": config.get("version", "?"), "preset": self.preset, "cpu": processor(),
                   "cores": os.cpu_count(), "system": platform.platform(), "steps": self.measured}
        with open(self.path("machine.yaml.part"), "w") as stream:
            yaml.safe_dump(machine, stream, sort_keys=False)
        os.replace(self.path("machine.yaml.part"), self.path("machine.yaml"))


def to_run_any(log):
    """Whether a sweep had anything to run."""
    with open(log) as stream:
        return not re.search(r": 0 of \d+ seeds to run$", stream.read(), re.MULTILINE)


def processor():
    try:
        with open("/proc/cpuinfo") as stream:
            return next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "?"


def positive(text):
    if not re.match(r"[1-9]\d{0,4}$", text):
        raise argparse.ArgumentTypeError("must be a whole number >= 1, got '%s'" % text)
    return int(text)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reproduce_paper", description=ABOUT, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=positive, default=50, metavar="N", help="seeds 0 ... N - 1; default 50")
    parser.add_argument("--out", default="paper_results", metavar="DIR", help="default paper_results")
    parser.add_argument("--preset", default="paper", help="default paper; debug is for a quick look at the path")
    parser.add_argument("--jobs", type=positive, metavar="N", help="seeds at a time; default one per core")
    options = parser.parse_args(arguments)
    start = time.monotonic()
    try:
        agreement = Reproduction(options).run()
    except KeyboardInterrupt:
        print("reproduce_paper: interrupted; the same command goes on", file=sys.stderr)
        return 130
    except (Failure, RunFolderError, OSError, csv.Error) as error:
        print("reproduce_paper: %s" % error, file=sys.stderr)
        return 1
    for point, paper, here, holds in agreement:
        print("%-3s  %s: paper or bar %s, here %s" % (holds, point, paper, here))
    print("results: %s (%.0f s)" % (os.path.abspath(options.out), time.monotonic() - start))
    return 0
