# Walks through the steps of a reproduction: sweeps that resume, programs that draw, and machine.yaml about both.
# SPDX-License-Identifier: BSD-3-Clause
"""What reproduce_paper and reproduce_efficient share. Each is a StepRunner that says what to run (work())."""
import csv
import glob
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

from ddm_launch.interruption import Interrupted, raised_as_exception
from ddm_launch.run_folder import RunFolderError
from ddm_launch.sweep_folder import differences, read_yaml, with_versions
from ddm_model.plain_file import write_file

# Where the file NAME.yaml lies that an option names: package, folder of its config/.
FOLDERS = {"--preset": ("ddm_launch", "presets"), "--method": ("ddm_launch", "methods"),
           "--nuisance": ("ddm_launch", "nuisances"), "--plant": ("ddm_sim", "")}
METHODS_WITHOUT_FILE = ("ddm", "oracle")
TIME_IS_UP = 124  # exit code of timeout(1)


class Failure(Exception):
    """A step failed; the message tells which and where to look."""


def program(name, package="ddm_launch"):
    found = roslib.packages.find_node(package, name)
    if not found:
        raise Failure("the program %s of %s is not there: build the workspace, then source its devel/setup.bash"
                      % (name, package))
    return found[0]


def package_path(*names, package="ddm_launch"):
    return os.path.join(roslib.packages.get_pkg_dir(package), *names)


def require_pilco_in_build(without):
    """without: the option that leaves PILCO out."""
    about = subprocess.run([program("run_experiment"), "--help"], stdout=subprocess.PIPE, universal_newlines=True)
    if "pilco_state:" not in about.stdout:
        raise Failure("PILCO is not in this build of run_experiment: build with -DDDM_PILCO=ON, or say %s" % without)


class SweepStep:
    """Many seeds of one program; their rows end in TABLE.

    name: of its folder in OUT/runs. words, more: options of sweep, and those that it hands on. limit_s: the sweep is
    ended when its calls together took so long, and the rows of the trials that are finished by then are kept [s]; None:
    no limit.
    """

    def __init__(self, name, table, seeds, words, more=(), limit_s=None):
        self.name, self.table, self.seeds, self.words, self.more = name, table, seeds, words, more
        self.limit_s = limit_s

    def command(self, out, jobs, left_s=None):
        """left_s: how much of the time limit is left [s]."""
        limit = [] if left_s is None else ["timeout", "--foreground", "--signal=INT", "%.1f" % left_s]
        return (limit + [program("sweep"), "--seeds", "%d:%d" % (self.seeds[0], self.seeds[-1] + 1), "--out",
                         self.folder(out)] + self.words + (["--jobs", str(jobs)] if jobs else []) +
                (["--"] + list(self.more) if self.more else []))

    def folder(self, out):
        return os.path.join(out, "runs", self.name)

    def seed_folder(self, out, seed):
        return os.path.join(self.folder(out), "seed_%04d" % seed)

    def seed_folders(self, out, most_seeds=sys.maxsize):
        """{seed: its run folder} of the first seeds."""
        return {seed: self.seed_folder(out, seed) for seed in self.seeds[:most_seeds]}

    def files(self):
        """{kind and name: path} of the files that this step names. Those of --config are counted: a later one has the
        last word, and two may have the same name."""
        words, files, num_configs = list(self.words) + list(self.more), {}, 0
        for option, value in zip(words, words[1:]):
            if option == "--config":
                num_configs += 1
                files["config %d %s" % (num_configs, os.path.basename(value))] = value
            elif option in FOLDERS and not (option == "--method" and value in METHODS_WITHOUT_FILE):
                package, folder = FOLDERS[option]
                files["%s %s" % (option[2:], value)] = package_path("config", folder, value + ".yaml", package=package)
        return files

    def settings(self):
        """What these files say."""
        return {name: read_yaml(path) for name, path in self.files().items()}


class StepRunner:
    """A reproduction into the folder `out`:

      logs/             what each program said
      runs/STEP/        the sweep of a step; settings.yaml: the files that it was made with
      machine.yaml      of each step: version of the code, processor, time, peak memory
    """

    def __init__(self, name, out, about, jobs):
        """name: of the program, for its messages. about: what machine.yaml begins with. jobs: None, or at a time."""
        self.name, self.out, self.about, self.jobs = name, os.path.abspath(out), about, jobs
        self.measured = {}  # step: what write_machine() keeps of it

    def work(self):
        """Makes everything, and returns the lines to print in the end."""
        raise NotImplementedError

    def run(self):
        """Works, and tells how it ended. Returns the exit code."""
        start = time.monotonic()
        try:
            with raised_as_exception():
                os.makedirs(self.path("logs"), exist_ok=True)
                self.measured = read_yaml(self.path("machine.yaml")).get("steps") or {}
                lines = self.work()
        except Interrupted as error:
            print("%s: %s; the same command goes on" % (self.name, error), file=sys.stderr)
            return 128 + error.number
        except (Failure, RunFolderError, OSError, csv.Error) as error:
            print("%s: %s" % (self.name, error), file=sys.stderr)
            return 1
        for line in lines:
            print(line)
        self.warn_of_versions()
        print("results: %s (%.0f s)" % (self.out, time.monotonic() - start))
        return 0

    def path(self, *names):
        return os.path.join(self.out, *names)

    def progress(self, total):
        """The bar: a step of it is a finished seed, a figure, or the tables."""
        return tqdm(total=total, unit="step", dynamic_ncols=True, disable=None, smoothing=0.05)

    def keep(self, source, name):
        """Copies a result to where it is kept."""
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        shutil.copyfile(source, self.path(name))

    def run_sweep(self, step, bar):
        """Runs the seeds that are not finished, moves the bar by each that is, and keeps the table."""
        bar.set_description(step.name)
        self.forget_removed(step)
        self.require_settings(step)
        start, code, num_seen = time.monotonic(), TIME_IS_UP, 0
        left_s = self.time_left(step)
        if left_s is None or left_s >= 1.0:
            code, num_seen = self.call_sweep(step, left_s, bar)
        if code != 0 and not (left_s is not None and code == TIME_IS_UP):
            raise Failure("%s: not all seeds are finished, see %s; the same command goes on" % (
                step.name, self.path("logs", step.name + ".log")))
        bar.update(len(step.seeds) - num_seen)
        tqdm.write("%-36s %4d seeds  %6.1f s%s" % (step.name, len(step.seeds), time.monotonic() - start,
                                                   "" if code == 0 else ", its time is up"))
        if code == 0:
            self.keep(os.path.join(step.folder(self.out), "sweep.csv"), step.table)
        else:
            self.keep_finished_trials(step)

    def forget_removed(self, step):
        """A step whose folder was removed begins anew: its measurements, and the time that it has used, are gone."""
        if step.name in self.measured and not os.path.isdir(step.folder(self.out)):
            del self.measured[step.name]
            self.write_machine()

    def time_left(self, step):
        """Of a step's limit [s], after all calls so far; None: it has no limit."""
        if step.limit_s is None:
            return None
        return step.limit_s - self.measured.get(step.name, {}).get("wall_s", 0.0)

    def call_sweep(self, step, left_s, bar):
        """Returns (exit code, number of finished seeds that moved the bar)."""
        start, num_finished, num_run, peak_kb = time.monotonic(), 0, 0, 0
        with open(self.path("logs", step.name + ".log"), "w") as stream:
            process = subprocess.Popen(step.command(self.out, self.jobs, left_s), stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            try:
                for line in process.stdout:
                    stream.write(line)
                    stream.flush()
                    to_run = re.search(r": (\d+) of \d+ seeds to run$", line.strip())
                    if to_run:
                        self.keep_settings(step)
                        num_finished = len(step.seeds) - int(to_run.group(1))
                        bar.update(num_finished)
                    elif re.match(r"seed \d+ finished", line):
                        num_run += 1
                        bar.update(1)
            except BaseException:
                process.send_signal(signal.SIGINT)
                raise
            finally:
                peak_kb = reap(process)
                if num_run or left_s is not None:
                    self.add_measurement(step, num_run, time.monotonic() - start, peak_kb / 1024.0)
        return process.returncode, num_finished + num_run

    def require_settings(self, step):
        """A sweep does not look at finished seeds again: they must not come from files that have changed since."""
        folder = step.folder(self.out)
        path = os.path.join(folder, "settings.yaml")
        if not os.path.exists(path):
            summaries = glob.glob(os.path.join(glob.escape(folder), "seed_*", "summary.yaml"))
            if any(read_yaml(summary).get("finished") is True for summary in summaries):
                raise Failure("%s holds finished seeds but no settings.yaml, which says what they were made with: "
                              "remove that folder, or use another --out" % folder)
            return
        found = differences(read_yaml(path), step.settings())
        if found:
            raise Failure("%s holds results of other settings: remove that folder, or use another --out:\n - %s" % (
                folder, "\n - ".join(found)))

    def keep_settings(self, step):
        write_file(os.path.join(step.folder(self.out), "settings.yaml"),
                   yaml.safe_dump(step.settings(), sort_keys=False))

    def keep_finished_trials(self, step):
        """The table of a sweep whose time was up: of each seed as many trials as it has. Without any there is no
        table, nor one of seeds that have been removed."""
        lines = []
        for folder in step.seed_folders(self.out).values():
            path = os.path.join(folder, "trials.csv")
            if os.path.exists(path):
                with open(path) as stream:
                    header, *rows = with_versions(stream.read().splitlines())
                lines += rows if lines else [header] + rows
        if lines:
            os.makedirs(os.path.dirname(self.path(step.table)), exist_ok=True)
            write_file(self.path(step.table), "\n".join(lines) + "\n")
        elif os.path.exists(self.path(step.table)):
            os.remove(self.path(step.table))

    def add_measurement(self, step, num_run, wall_s, peak_memory_mb):
        """Keeps what a call took. Calls add up; seeds that an interruption cut short count with their time alone."""
        config = read_yaml(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml"))
        before = self.measured.get(step.name, {})
        self.measured[step.name] = {
            "seeds_run": before.get("seeds_run", 0) + num_run, "version": config.get("version", "?"),
            "cpu": processor(), "cores": os.cpu_count(), "wall_s": round(before.get("wall_s", 0.0) + wall_s, 1),
            "peak_memory_mb": round(max(before.get("peak_memory_mb", 0.0), peak_memory_mb), 1)}
        self.write_machine()

    def write_machine(self):
        """With what the figures were made, step by step."""
        machine = dict(self.about, system=platform.platform(), steps=self.measured)
        write_file(self.path("machine.yaml"), yaml.safe_dump(machine, sort_keys=False))

    def warn_of_versions(self):
        versions = sorted({step["version"] for step in self.measured.values()})
        if len(versions) > 1:
            print("%s: note: the steps come from %d versions of the code: %s" % (
                self.name, len(versions), ", ".join(versions)), file=sys.stderr)

    def call(self, name, command):
        log = self.path("logs", name + ".log")
        with open(log, "w") as stream:
            code = subprocess.call(command, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT)
        if code != 0:
            raise Failure("%s: '%s' failed with code %d, see %s" % (name, " ".join(command), code, log))

    def draw(self, figures, bar):
        """figures: (name, command) of each."""
        for name, command in figures:
            bar.set_description(name)
            self.call(name, command)
            bar.update(1)


def verdict_lines(rows):
    """Lines to print about rows (point, claim, here, verdict)."""
    return ["%-3s  %s: %s; here %s" % (holds, point, claim, here) for point, claim, here, holds in rows]


def reap(process):
    """Waits for a process. Returns the largest memory that it or one of its own has taken [kB]."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.WEXITSTATUS(status) if os.WIFEXITED(status) else -os.WTERMSIG(status)
    return usage.ru_maxrss


def processor():
    try:
        with open("/proc/cpuinfo") as stream:
            return next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "?"
