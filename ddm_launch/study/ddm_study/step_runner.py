# Walks through the steps of a reproduction: sweeps that resume, figures, and machine.yaml about both.
# SPDX-License-Identifier: BSD-3-Clause
"""What reproduce_paper and reproduce_efficient share. Each is a StepRunner that says what to run: its parts()."""
import collections
import os
import shutil
import signal
import subprocess
import sys
import time

from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, Interrupted, distribution, find_program, package_path, processor, run_program
from ddm_launch.run_folder import is_finished, num_finished
from ddm_launch.settings import differences, read_yaml
from ddm_model.plain_file import write_file

# Where the file NAME.yaml lies that an option names: package, folder of its config/.
FOLDERS = {"--preset": ("ddm_launch", "presets"), "--method": ("ddm_launch", "methods"),
           "--nuisance": ("ddm_launch", "nuisances"), "--plant": ("ddm_sim", "")}
METHODS_WITHOUT_FILE = ("ddm",)
POLL_S = 0.2


class SweepStep:
    """Many seeds of one program; their rows end in TABLE.

    name: of its folder in OUT/runs. words, more: options of sweep, and those that it hands on. limit_s: the sweep is
    ended when its calls together took so long, and the rows of the trials that are finished by then are kept [s]; None:
    no limit.
    """

    def __init__(self, name, table, seeds, words, more=(), limit_s=None):
        self.name, self.table, self.seeds, self.words, self.more = name, table, seeds, list(words), list(more)
        self.limit_s = limit_s

    def command(self, out, jobs):
        return ([find_program("sweep"), "--seeds", "%d:%d" % (self.seeds[0], self.seeds[-1] + 1), "--out",
                 self.folder(out)] + self.words + (["--jobs", str(jobs)] if jobs else []) +
                (["--"] + self.more if self.more else []))

    def folder(self, out):
        return os.path.join(out, "runs", self.name)

    def seed_folder(self, out, seed):
        return os.path.join(self.folder(out), "seed_%04d" % seed)

    def seed_folders(self, out, most_seeds=None):
        """{seed: its run folder} of the first seeds."""
        return {seed: self.seed_folder(out, seed) for seed in self.seeds[:most_seeds]}

    def finished(self, out, but=()):
        """The seeds that are finished, but for those that are known."""
        return {seed for seed, folder in self.seed_folders(out).items() if seed not in but and is_finished(folder)}

    def files(self):
        """{kind and name: path} of the files that this step names. Those of --config are counted: a later one
        overrides an earlier one, and two may have the same name."""
        words, files, num_configs = self.words + self.more, {}, 0
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


# steps: its sweeps. write_tables(). figures(): {name: command that draws what is kept}, asked when all is there.
Part = collections.namedtuple("Part", "steps write_tables figures")


class StepRunner:
    """A reproduction into the folder `out`:

      logs/             what each program printed
      runs/STEP/        the sweep of a step; settings.yaml: the files that it was made with
      machine.yaml      of each step: version of the code, processor, time, peak memory, seeds that were interrupted
    """

    def __init__(self, name, out, about, jobs):
        """name: of the program, for its messages. about: what machine.yaml begins with. jobs: None, or at a time."""
        self.name, self.out, self.about, self.jobs = name, os.path.abspath(out), about, jobs
        self.measured = {}  # step: what machine.yaml has of it

    def parts(self):
        """{name: Part}, in the order in which to make them. Raises Failure if something is missing for one."""
        raise NotImplementedError

    def verdict(self):
        """The lines to print in the end."""
        raise NotImplementedError

    def run(self):
        """Returns the exit code."""
        return run_program(self.name, self.work)

    def work(self):
        start = time.monotonic()
        os.makedirs(self.path("logs"), exist_ok=True)
        self.measured = read_yaml(self.path("machine.yaml")).get("steps") or {}
        parts = self.parts()
        total = sum(len(step.seeds) for part in parts.values() for step in part.steps) + 2 * len(parts)
        try:
            # a step of the bar is a finished seed, the tables, or the figures
            with tqdm(total=total, unit="step", dynamic_ncols=True, disable=None, smoothing=0.05) as bar:
                for name, part in parts.items():
                    for step in part.steps:
                        self.run_sweep(step, bar)
                    bar.set_description(name + ": tables")
                    part.write_tables()
                    bar.update(1)
                    bar.set_description(name + ": figures")
                    for figure, command in part.figures().items():
                        self.call("figure_of_" + figure, command)
                    bar.update(1)
        except Interrupted:
            print("%s: the same command resumes" % self.name, file=sys.stderr)
            raise
        print("\n".join(self.verdict() + ["results: %s (%.0f s)" % (self.out, time.monotonic() - start)]))
        versions = sorted({step["version"] for step in self.measured.values()})
        if len(versions) > 1:
            print("%s: note: the steps come from %d versions of the code: %s" % (
                self.name, len(versions), ", ".join(versions)), file=sys.stderr)

    def require_pilco(self, table, is_wanted, without):
        """Before hours have passed: PILCO must be there where it is wanted, and no results of it where it is not.

        without: the option that leaves it out.
        """
        if not is_wanted and os.path.exists(self.path(table)):
            raise Failure("%s holds results of PILCO, which %s leaves out: remove it, leave out that option, or use "
                          "another --out" % (self.path(table), without))
        # It ends with code 2 if it does not know the method, and with 1 where no run can be.
        asked = [find_program("run_experiment"), "--preset", "debug", "--method", "pilco_state", "--out", os.devnull]
        if is_wanted and subprocess.call(asked, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                         stderr=subprocess.DEVNULL) == 2:
            raise Failure("PILCO is not in this build of run_experiment: build with -DDDM_PILCO=ON, or say %s" % without)

    def path(self, *names):
        return os.path.join(self.out, *names)

    def figure(self, program, kind, words, name=None):
        """The command that draws a figure of this kind into OUT/NAME.png."""
        return [find_program(program), kind] + words + ["--out", self.path((name or kind) + ".png")]

    def keep(self, source, name):
        """Copies a result to where it is kept."""
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        shutil.copyfile(source, self.path(name))

    def keep_config(self, step, name):
        """That of the first seed. Its run folder is named as seen from DIR: no path of a machine is kept."""
        with open(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml")) as stream:
            text = stream.read()
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w") as stream:
            stream.write(text.replace(os.path.join(os.path.abspath(self.out), ""), ""))

    def run_sweep(self, step, bar):
        """Runs the seeds that are not finished, moves the bar by each that is, and keeps the table."""
        bar.set_description(step.name)
        if step.name in self.measured and not os.path.isdir(step.folder(self.out)):
            del self.measured[step.name]  # the folder was removed: the step begins anew, with all its time
            self.write_machine()
        self.require_settings(step)
        start, left_s = time.monotonic(), None
        if step.limit_s is not None:
            left_s = step.limit_s - self.measured.get(step.name, {}).get("wall_s", 0.0)
        shown = set()

        def show():
            found = step.finished(self.out, shown)
            shown.update(found)
            bar.update(len(found))

        is_complete = (left_s is None or left_s >= 1.0) and self.call_sweep(step, left_s, show)
        bar.update(len(step.seeds) - len(shown))
        tqdm.write("%-36s %4d seeds  %6.1f s%s" % (step.name, len(step.seeds), time.monotonic() - start,
                                                   "" if is_complete else ", its time is up"))
        if is_complete:
            self.keep(os.path.join(step.folder(self.out), "sweep.csv"), step.table)
        else:
            self.keep_finished_trials(step)

    def call_sweep(self, step, left_s, show):
        """Returns whether all seeds are finished; if not, the time is up. show() is called while the sweep runs."""
        write_file(os.path.join(step.folder(self.out), "settings.yaml"), yaml.safe_dump(step.settings(), sort_keys=False))
        before = step.finished(self.out)
        resumed = [seed for seed, folder in step.seed_folders(self.out).items()
                   if seed not in before and num_finished(folder) > 0]
        start, is_up, ended = time.monotonic(), False, 0
        log = self.path("logs", step.name + ".log")
        with open(log, "w") as stream:
            process = subprocess.Popen(step.command(self.out, self.jobs), stdin=subprocess.DEVNULL, stdout=stream,
                                       stderr=subprocess.STDOUT)
        try:
            while not ended:
                time.sleep(POLL_S)
                show()
                if not is_up and left_s is not None and time.monotonic() - start > left_s:
                    is_up = True
                    os.kill(process.pid, signal.SIGINT)
                ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        finally:
            if not ended:
                os.kill(process.pid, signal.SIGINT)
                _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status  # it has been waited for
            num_run = len(step.finished(self.out, before))
            if num_run or left_s is not None:
                self.add_measurement(step, num_run, time.monotonic() - start, usage.ru_maxrss / 1024.0, resumed)
        if status != 0 and not is_up:
            raise Failure("%s: not all seeds are finished, see %s; the same command resumes" % (step.name, log))
        return status == 0

    def require_settings(self, step):
        """A sweep does not look at finished seeds again: they must not come from files that have changed since."""
        folder = step.folder(self.out)
        path = os.path.join(folder, "settings.yaml")
        os.makedirs(folder, exist_ok=True)
        if not step.finished(self.out):
            return
        if not os.path.exists(path):
            raise Failure("%s holds finished seeds but no settings.yaml, which says what they were made with: remove "
                          "that folder, or use another --out" % folder)
        found = differences(read_yaml(path), step.settings())
        if found:
            raise Failure("%s holds results of other settings: remove that folder, or use another --out:\n - %s" % (
                folder, "\n - ".join(found)))

    def keep_finished_trials(self, step):
        """The table of a sweep whose time was up: of each seed as many trials as it has. Without any there is no
        table, nor one of seeds that have been removed."""
        lines, table = [], self.path(step.table)
        for folder in step.seed_folders(self.out).values():
            path = os.path.join(folder, "trials.csv")
            if os.path.exists(path):
                with open(path) as stream:
                    header, *rows = stream.read().splitlines()
                lines += rows if lines else [header] + rows
        if lines:
            os.makedirs(os.path.dirname(table), exist_ok=True)
            write_file(table, "\n".join(lines) + "\n")
        elif os.path.exists(table):
            os.remove(table)

    def add_measurement(self, step, num_run, wall_s, peak_memory_mb, resumed):
        """Keeps what a call took. Calls add up; seeds that an interruption cut short count with their time alone."""
        config = read_yaml(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml"))
        before = self.measured.get(step.name, {})
        resumed = sorted(set(before.get("resumed", []) + resumed))
        self.measured[step.name] = {
            "seeds_run": before.get("seeds_run", 0) + num_run, "version": config.get("version", "?"),
            "cpu": processor(), "cores": os.cpu_count(), "wall_s": round(before.get("wall_s", 0.0) + wall_s, 1),
            "peak_memory_mb": round(max(before.get("peak_memory_mb", 0.0), peak_memory_mb), 1),
            **({"resumed": resumed} if resumed else {})}
        self.write_machine()

    def resumed(self, step):
        """The seeds of a step that took more than one call."""
        return self.measured.get(step.name, {}).get("resumed", [])

    def write_machine(self):
        """With what the figures were made, step by step."""
        machine = dict(self.about, system=distribution(), steps=self.measured)
        write_file(self.path("machine.yaml"), yaml.safe_dump(machine, sort_keys=False))

    def call(self, name, command):
        log = self.path("logs", name + ".log")
        with open(log, "w") as stream:
            code = subprocess.call(command, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT)
        if code != 0:
            raise Failure("%s: '%s' failed with code %d, see %s" % (name, " ".join(command), code, log))


def verdict_lines(rows):
    """Lines to print about rows (point, claim, here, verdict)."""
    return ["%-3s  %s: %s; here %s" % (holds, point, claim, here) for point, claim, here, holds in rows]
