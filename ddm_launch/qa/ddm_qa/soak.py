# soak: long experiments of the real nodes, and what becomes of each process and of each frame in them.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re
import shutil
import socket
import time

import rosbag
import rosgraph
from tqdm import tqdm

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.run_folder import is_finished, num_finished, read_setting, read_trajectory
from ddm_launch.tables import read_table, write_csv
from ddm_qa.processes import free_port, pid_of, start_roslaunch

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
GROWTH = 0.05  # of resident memory, since the first tenth of the trials: trial 30 of 300
IMAGES = 2.0  # that model_node may keep of each frame of a trial: one, and what else it needs

# last: the trial after which it is judged; one more follows, so that the nodes are still there. seconds: after which it is
# ended, from its first trial on. One of both is None. image_bytes: of an image, if those that model_node keeps may make it
# grow.
Soak = collections.namedtuple("Soak", "name config arguments last seconds image_bytes")
# Of a node after a trial. time_s: since the first trial began.
Sample = collections.namedtuple("Sample", "run node trial time_s rss_kb open_files")
# Of a trial or of its evaluation. A frame is lost if the camera did not show it, if it did not arrive, or if no torque
# answered it: all leave a gap between the times of those that were answered, which are dt apart.
Frames = collections.namedtuple("Frames", "run trial part due answered lost")
# One row of targets.csv; passed: 0 or 1.
Target = collections.namedtuple("Target", "run target measured passed")

ABOUT = """\
Runs long experiments of the real nodes and looks at each process after each trial: lockstep, 300 trials in a few
minutes, and real_time, an hour at the paper's time step. Memory and open files must stay flat, but for the images that
model_node keeps in lockstep, and no frame be lost."""

EPILOG = """\
DIR/soak.csv       run,node,trial,time_s,rss_kb,open_files: resident memory and open files of each node and of the master
DIR/frames.csv     run,trial,part,due,answered,lost: a row a trial, and one for its evaluation
DIR/targets.csv    run,target,measured,passed
Results of a run that is not asked for stay. Exit code: 0 all passed, 1 not, 2 bad options."""


def judge(run, last, samples, frames, image_bytes=None):
    """All targets of a run. last: number of its last trial; samples, frames: of this run; image_bytes: as in Soak."""
    targets, tenth, nodes = [], max(1, last // 10), {}
    for sample in samples:
        nodes.setdefault(sample.node, []).append(sample)
    for node, of_node in sorted(nodes.items()):
        first, end = next(sample for sample in of_node if sample.trial >= tenth), of_node[-1]
        grown = end.rss_kb / first.rss_kb - 1.0
        measured = "%.1f MB after trial %d, %.1f MB after trial %d: %+.1f %%" % (
            first.rss_kb / 1024.0, first.trial, end.rss_kb / 1024.0, end.trial, 100.0 * grown)
        passed = grown <= GROWTH
        if image_bytes and node == "model_node":
            num_kept = sum(row.answered for row in frames if row.part == "trial" and first.trial < row.trial <= end.trial)
            images = 1024.0 * (end.rss_kb - first.rss_kb) / image_bytes / max(1, num_kept)
            measured, passed = "%s, %.2f images a frame" % (measured, images), images <= IMAGES
        targets.append(Target(run, "resident memory of %s" % node, measured, int(passed and end.trial == last)))
        # The maximum depends on whether a bag happens to be open when a sample is taken. The minimum does not, and a leak
        # raises it.
        early = min(sample.open_files for sample in of_node if tenth <= sample.trial <= 2 * tenth)
        late = min(sample.open_files for sample in of_node if sample.trial >= last - tenth)
        targets.append(Target(run, "open files of %s" % node, "at least %d in trials %d to %d, %d in trials %d to %d" % (
            early, tenth, 2 * tenth, late, last - tenth, last), int(late <= early)))
    lost, due = sum(row.lost for row in frames), sum(row.due for row in frames)
    return targets + [Target(run, "lost frames", "%d of %d" % (lost, due), int(bool(frames) and lost == 0))]


def answered_times(bag_path):
    """Times of the images in a bag that have a torque [s]."""
    images, torques = set(), set()
    with rosbag.Bag(bag_path) as bag:
        for topic, message, _ in bag.read_messages(["camera/image_raw", "torque"]):
            (torques if topic == "torque" else images).add(message.header.stamp.to_nsec())
    return [1e-9 * stamp for stamp in sorted(images & torques)]


def count_frames(run, folder, num_trials):
    """Frames of the first trials of a run folder and of their evaluations, which are not recorded."""
    dt = float(read_setting(folder, "plant", "dt", "time between two images"))
    num_steps = int(read_setting(folder, "trial", "num_steps", "frames of a trial"))
    rows = []
    for trial in range(num_trials):
        for part, times in (("trial", answered_times(os.path.join(folder, "trial_%03d" % trial, "trial.bag"))),
                            ("evaluation", read_trajectory(os.path.join(folder, "evaluation_%03d" % trial)).time_s.tolist())):
            due = max(num_steps, int(round((times[-1] - times[0]) / dt)) + 1 if len(times) else 0)
            rows.append(Frames(run, trial, part, due, len(times), due - len(times)))
    return rows


class SoakRun:
    """One of them, in OUT/NAME: run, the folder of the experiment; ros, logs of its nodes; output.txt."""

    def __init__(self, soak, out):
        self.soak, self.folder = soak, os.path.join(out, soak.name)
        self.runs = os.path.join(self.folder, "run")
        self.samples, self.processes, self.begin = [], {}, None

    def make(self, on_progress):
        """Returns (samples, frames). on_progress: called with how much is done, in trials or seconds.
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
            with open("/proc/%d/status" % pid) as stream:
                rss_kb = int(re.search(r"VmRSS:\s+(\d+) kB", stream.read()).group(1))
            self.samples.append(Sample(self.soak.name, name, trial, round(seconds, 2), rss_kb,
                                       len(os.listdir("/proc/%d/fd" % pid))))


def write_results(out, run, *tables):
    """Of a run; the rows of other runs stay. tables: for each the kind of its rows and the rows."""
    for name, kind, rows in zip(("soak.csv", "frames.csv", "targets.csv"), (Sample, Frames, Target), tables):
        path = os.path.join(out, name)
        others = read_table(path).itertuples(index=False) if os.path.exists(path) else []
        write_csv(path, kind._fields, [list(row) for row in others if row.run != run]
                  + [list(row) for row in rows])


def make(soak, out):
    """Targets of a run, whose tables are written."""
    total = soak.last + 2 if soak.seconds is None else round(soak.seconds)
    with tqdm(total=total, desc=soak.name, unit="trial" if soak.seconds is None else "s", dynamic_ncols=True,
              disable=None) as bar:
        samples, frames = SoakRun(soak, out).make(lambda done: bar.update(min(total, int(done)) - bar.n))
    last = soak.last if soak.seconds is None else samples[-1].trial
    targets = judge(soak.name, last, samples, frames, soak.image_bytes)
    write_results(out, soak.name, samples, frames, targets)
    return targets


def run(options):
    out = os.path.abspath(options.out)
    os.makedirs(out, exist_ok=True)
    soaks = {"lockstep": Soak("lockstep", CONFIG % (LOCKSTEP_SIZE, 20), ["trials:=%d" % (options.trials + 1)], options.trials,
                              None, LOCKSTEP_SIZE ** 2),
             "real_time": Soak("real_time", CONFIG % (REAL_TIME_SIZE, options.steps) + LONG_TRAINING,
                               ["trials:=999", "real_time:=true"], None, 60.0 * options.minutes, None)}
    targets = [target for name in options.runs for target in make(soaks[name], out)]
    for target in targets:
        print("%-6s  %s: %s: %s" % ("passed" if target.passed else "failed", target.run, target.target, target.measured))
    num_passed = sum(target.passed for target in targets)
    print("results: %s" % out)
    print("%d passed, %d failed" % (num_passed, len(targets) - num_passed))
    return 0 if num_passed == len(targets) else 1


def main():
    parser = program_parser("soak", ABOUT, EPILOG)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for tables and the experiments")
    parser.add_argument("--runs", nargs="+", choices=["lockstep", "real_time"], default=["lockstep", "real_time"],
                        help="which (default: both, one by one)")
    parser.add_argument("--trials", type=number(int, 1, 998), default=300, metavar="N",
                        help="of lockstep (default: %(default)s)")
    parser.add_argument("--minutes", type=number(float, 0.01), default=60.0, metavar="M",
                        help="of real_time (default: %(default)g)")
    parser.add_argument("--steps", type=number(int, 10), default=100, metavar="K",
                        help="frames of a trial of real_time, 5 a second (default: %(default)s)")
    options = parser.parse_args()
    socket.setdefaulttimeout(CALL_LIMIT_S)
    return run_program("soak", lambda: run(options))
