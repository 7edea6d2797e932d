# soak: long experiments of the real nodes, what becomes of each process in them, and a figure of it.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import shutil
import socket
import time

import rosgraph
from tqdm import tqdm

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.figure_style import (BLUE, GREEN, GREY, ORANGE, PAGE_WIDTH, PURPLE, VERMILLION, new_figure,
                                     save)
from ddm_launch.run_folder import is_finished, num_finished
from ddm_launch.tables import read_csv, write_csv
from ddm_qa.processes import free_port, memory_kb, pid_of, start_roslaunch
from ddm_qa.soak_targets import (FRAME_COLUMNS, GROWTH, Sample, Target, after, by_node, count_frames, judge,
                              reference_trial)

RUNS = {"lockstep": "lock-step", "real_time": "real time"}  # name: title in the figure
CALL_LIMIT_S = 30.0  # of a question to a master or node
TRIAL_LIMIT_S = 300.0
POLL_S = 0.02
SEED = 1
# Data are kept, so the memory of model_node grows with them by design. lockstep, with images of the usual size, says by how
# much; real_time has the smallest images, which leave only what else grows. The camera's own are as large as ever in both.
CONFIG = """\
image: {size: %d}
model: {pca_dim: 5, encoder_widths: [], predictor_widths: []}
evaluation: {settled_steps: 3, settled_steps_strict: 6}
trial: {num_steps: %d}
"""
LOCKSTEP_SIZE, REAL_TIME_SIZE = 51, 5  # of an image [pixels]
LONG_TRAINING = "training: {max_iterations: 1000, function_tolerance: 1.0e-12}\n"
LINES = [(BLUE, "-"), (VERMILLION, "--"), (GREEN, "-."), (ORANGE, "-"), (PURPLE, "--")]
NOT_DRAWN = ("master", "rosout")  # ROS's own, which targets.csv judges like all others

# last: the trial after which it is judged; one more follows, so that the nodes are still there. seconds: after which it is
# ended, from its first trial on. One of both is None.
Soak = collections.namedtuple("Soak", "name config arguments last seconds")

ABOUT = """\
Runs long experiments of the real nodes and looks at each process after each trial: lockstep, 300 trials in a few
minutes, and real_time, an hour at the paper's time step. Memory and open files must stay flat, but for the images that
model_node keeps in lockstep, and no frame be lost."""

EPILOG = """\
DIR/soak.csv    run,node,trial,time_s,rss_kb,open_files: resident memory and open files of each node and of the master
DIR/frames.csv  run,trial,part,due,published,recorded,answered,lost: a row a trial, and one for its evaluation
DIR/targets.csv    run,target,measured,passed
DIR/soak.png    memory and open files over the trials
Results of a run that is not asked for stay. Exit code: 0 all passed, 1 not, 2 bad options."""


class SoakRun:
    """One of them, in OUT/NAME: run, the folder of the experiment; ros, logs of its nodes; output.txt."""

    def __init__(self, soak, out):
        self.soak, self.folder = soak, os.path.join(out, soak.name)
        self.runs = os.path.join(self.folder, "run")
        self.samples, self.processes, self.begin = [], {}, None

    def make(self, on_progress):
        """Returns (samples, rows of frames.csv). on_progress: called with how much is done, in trials or seconds.
        Raises Failure if the experiment ends too early or hangs."""
        shutil.rmtree(self.folder, ignore_errors=True)
        os.makedirs(self.folder)
        config = os.path.join(self.folder, "config.yaml")
        with open(config, "w") as stream:
            stream.write(self.soak.config)
        port = free_port()
        launch = start_roslaunch(os.path.join(self.folder, "ros"), "experiment.launch", "preset:=debug",
                                 "seed:=%d" % SEED, "config:=" + config, "runs:=" + self.runs, *self.soak.arguments,
                                 port=port)
        try:
            self.follow(launch, rosgraph.Master("/soak", "http://localhost:%d" % port), on_progress)
        finally:
            launch.stop()
            with open(os.path.join(self.folder, "output.txt"), "w") as stream:
                stream.write(launch.output)
        if self.soak.seconds is None and not is_finished(self.runs):
            raise self.failure(launch, "the experiment did not finish")
        if not self.samples or self.samples[-1].trial == 0:
            raise self.failure(launch, "fewer than two trials ended: raise --minutes or --trials")
        return self.samples, count_frames(self.soak.name, self.runs, self.samples[-1].trial + 1)

    def failure(self, launch, what):
        return Failure("%s: %s:\n%s" % (self.soak.name, what, launch.output[-2000:]))

    def follow(self, launch, master, on_progress):
        news, count = time.monotonic(), 0
        while launch.isRunning():
            time.sleep(POLL_S)
            now = time.monotonic()
            if self.begin is None and os.path.isdir(os.path.join(self.runs, "trial_000")):
                self.begin = news = now  # all nodes are there, and connected
            if num_finished(self.runs) > count:
                news, count = now, num_finished(self.runs)
                if self.soak.last is None or count <= self.soak.last + 1:
                    self.look(master, count - 1, now - self.begin)
            if now - news > TRIAL_LIMIT_S:
                raise self.failure(launch, "no trial has ended within %g s" % TRIAL_LIMIT_S)
            if self.soak.seconds is None:
                on_progress(count)
            elif self.begin is not None:
                on_progress(now - self.begin)
                if now - self.begin > self.soak.seconds:
                    return
        if self.soak.seconds is not None:
            raise self.failure(launch, "the experiment ended before its time")

    def look(self, master, trial, seconds):
        if not self.processes:
            nodes = sorted({name for topics in master.getSystemState() for _, names in topics for name in names})
            self.processes = {name.lstrip("/"): pid_of(master, name) for name in nodes + ["master"]}
        for name, pid in self.processes.items():
            self.samples.append(Sample(self.soak.name, name, trial, round(seconds, 2), memory_kb(pid, "VmRSS"),
                                       len(os.listdir("/proc/%d/fd" % pid))))


def draw_run(samples, memory, files):
    """Both panels of a run; samples: of this run."""
    last = max(sample.trial for sample in samples)
    reference = reference_trial(last)
    drawn = sorted((node, of_node) for node, of_node in by_node(samples).items() if node not in NOT_DRAWN)
    for (node, of_node), (color, dashes) in zip(drawn, LINES):
        trials = [sample.trial for sample in of_node]
        base = after(of_node, reference).rss_kb
        memory.plot(trials, [100.0 * (sample.rss_kb / base - 1.0) for sample in of_node], dashes, color=color)
        files.plot(trials, [sample.open_files for sample in of_node], dashes, color=color,
                   label="%s, %.0f MB" % (node, base / 1024.0))
    memory.axhline(100.0 * GROWTH, color=GREY, linewidth=0.8)
    but_for = ", but for model_node" if samples[0].run == "lockstep" else ""
    memory.text(0.01, 100.0 * GROWTH - 0.1, "at most after the last trial" + but_for, transform=memory.get_yaxis_transform(),
                verticalalignment="top", color=GREY, fontsize=7)
    memory.axvline(reference, color=GREY, linewidth=0.8, linestyle=":")
    minutes = max(sample.time_s for sample in samples) / 60.0
    memory.set_title("%s: %d trials in %.1f min" % (RUNS[samples[0].run], last, minutes))
    memory.set_ylabel("resident memory,\nchange since trial %d [%%]" % reference)
    files.set_ylabel("open files [-]")
    files.set_ylim(0.0, None)
    files.set_xlabel("trial [-]")
    files.legend(loc="upper center", bbox_to_anchor=(0.5, -0.35), ncol=2, handlelength=2.4, frameon=False,
                 title="node, memory after trial %d" % reference, title_fontsize=7)
    for axes in (memory, files):
        axes.grid(True)


def draw(samples, out):
    runs = sorted({sample.run for sample in samples})
    with new_figure(PAGE_WIDTH, 4.4) as figure:
        panels = figure.subplots(2, len(runs), sharex="col", squeeze=False,
                                 gridspec_kw={"height_ratios": [2, 1]})
        for run, memory, files in zip(runs, *panels):
            draw_run([sample for sample in samples if sample.run == run], memory, files)
        save(figure, out)


def write_results(out, run, samples, frames, targets):
    """Of a run; the rows of other runs stay."""
    counts = [[row[column] for column in FRAME_COLUMNS] for row in frames]
    for name, columns, rows in (("soak.csv", Sample._fields, samples), ("targets.csv", Target._fields, targets),
                                ("frames.csv", FRAME_COLUMNS, counts)):
        path = os.path.join(out, name)
        others = [[row[column] for column in columns] for row in read_csv(path, columns)
                  if row["run"] != run] if os.path.exists(path) else []
        write_csv(path, columns, sorted(others + [list(map(str, row)) for row in rows],
                                        key=lambda row: list(RUNS).index(row[0])))
    draw(read_samples(os.path.join(out, "soak.csv")), os.path.join(out, "soak.png"))


def read_samples(path):
    kinds = dict(zip(Sample._fields, (str, str, int, float, int, int)))
    return [Sample(*(row[name] for name in Sample._fields)) for row in read_csv(path, kinds)]


def make(soak, out):
    """Runs one and writes what came of it. Returns its targets."""
    with tqdm(total=soak.seconds or soak.last + 2, unit="s" if soak.seconds else "trial", desc=soak.name,
              dynamic_ncols=True, disable=None, bar_format="{l_bar}{bar}| {n:.0f}/{total:.0f} {unit}") as progress:
        samples, frames = SoakRun(soak, out).make(lambda done: progress.update(done - progress.n))
    image_bytes = LOCKSTEP_SIZE ** 2 if soak.name == "lockstep" else None
    targets = judge(soak.name, samples[-1].trial if soak.last is None else soak.last, samples, frames, image_bytes)
    write_results(out, soak.name, samples, frames, targets)
    return targets


def run(options):
    out = os.path.abspath(options.out)
    os.makedirs(out, exist_ok=True)
    soaks = {"lockstep": Soak("lockstep", CONFIG % (LOCKSTEP_SIZE, 20), ["trials:=%d" % (options.trials + 1)], options.trials, None),
             "real_time": Soak("real_time", CONFIG % (REAL_TIME_SIZE, options.steps) + LONG_TRAINING,
                               ["trials:=999", "real_time:=true"], None, 60.0 * options.minutes)}
    targets = [target for name in options.runs for target in make(soaks[name], out)]
    for target in targets:
        print("%-6s  %s: %s: %s" % ("passed" if target.passed else "failed", target.run, target.target, target.measured))
    num_passed = sum(target.passed for target in targets)
    print("results: %s" % out)
    print("%d passed, %d failed" % (num_passed, len(targets) - num_passed))
    return 0 if num_passed == len(targets) else 1


def main():
    parser = program_parser("soak", ABOUT, EPILOG)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for tables, figure and the experiments")
    parser.add_argument("--runs", nargs="+", choices=RUNS, default=list(RUNS), help="which (default: both, one by one)")
    parser.add_argument("--trials", type=number(int, 1, 998), default=300, metavar="N",
                        help="of lockstep (default: %(default)s)")
    parser.add_argument("--minutes", type=number(float, 0.01), default=60.0, metavar="M",
                        help="of real_time (default: %(default)g)")
    parser.add_argument("--steps", type=number(int, 10), default=100, metavar="K",
                        help="frames of a trial of real_time, 5 a second (default: %(default)s)")
    options = parser.parse_args()
    socket.setdefaulttimeout(CALL_LIMIT_S)
    return run_program("soak", lambda: run(options))
