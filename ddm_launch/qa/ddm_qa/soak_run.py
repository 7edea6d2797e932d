# Runs one long experiment of the real nodes and looks at each of them after each trial.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import shutil
import time

import rosgraph

from ddm_launch.command import Failure
from ddm_launch.run_folder import is_finished, num_finished
from ddm_qa.node_processes import memory_kb, num_open_files, pid_of
from ddm_qa.processes import start_roslaunch
from ddm_qa.programs import free_port
from ddm_qa.soak_bars import Sample
from ddm_qa.soak_frames import count_frames

POLL_S = 0.02
LIMIT_S = 300.0  # of a trial
SEED = 1
# Data are kept, so the memory of model_node grows with them by design. The images that it learns from are as small
# as they can be, since what is looked for is what else grows. The camera's own are as large as ever.
SMALL = """\
image: {size: 5}
model: {pca_dim: 5, encoder_widths: [], decoder_widths: [], predictor_widths: []}
"""
LOCKSTEP = SMALL + """\
trial: {num_steps: 20}
evaluation: {settled_steps: 3, settled_steps_strict: 6}
"""
REAL_TIME = SMALL + """\
trial: {num_steps: %d}
training: {max_iterations: 1000, function_tolerance: 1.0e-12}
evaluation: {settled_steps: 3, settled_steps_strict: 6}
"""

# last: the trial after which it is judged; one more follows, so that the nodes are still there. seconds: after which it is
# ended, from its first trial on. One of both is None.
Soak = collections.namedtuple("Soak", "name config arguments last seconds")


def lockstep(trials):
    return Soak("lockstep", LOCKSTEP, ["trials:=%d" % (trials + 1)], trials, None)


def real_time(minutes, num_steps):
    return Soak("real_time", REAL_TIME % num_steps, ["trials:=999", "real_time:=true"], None, 60.0 * minutes)


def find_processes(master):
    """{name: process} of all nodes, and of the master."""
    names = {name for topics in master.getSystemState() for _, nodes in topics for name in nodes}
    return dict({name.lstrip("/"): pid_of(master, name) for name in sorted(names)}, master=master.getPid())


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
            raise Failure("%s: the experiment did not finish:\n%s" % (self.soak.name, launch.output[-2000:]))
        return self.samples, count_frames(self.soak.name, self.runs, self.samples[-1].trial + 1)

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
            if now - news > LIMIT_S:
                raise Failure("%s: no trial has ended within %g s:\n%s" % (
                    self.soak.name, LIMIT_S, launch.output[-2000:]))
            if self.soak.seconds is None:
                on_progress(count)
            elif self.begin is not None:
                on_progress(now - self.begin)
                if now - self.begin > self.soak.seconds:
                    return
        if self.soak.seconds is not None:
            raise Failure("%s: the experiment ended after %.0f s:\n%s" % (
                self.soak.name, time.monotonic() - self.begin, launch.output[-2000:]))

    def look(self, master, trial, seconds):
        if not self.processes:
            self.processes = find_processes(master)
        for name, pid in self.processes.items():
            self.samples.append(Sample(self.soak.name, name, trial, round(seconds, 2), memory_kb(pid, "VmRSS"),
                                       num_open_files(pid)))
