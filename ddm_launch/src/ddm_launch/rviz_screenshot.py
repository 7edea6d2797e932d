# Runs an experiment with the real rviz on a screen in memory, checks its displays, and keeps the picture.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
from PIL import Image

from ddm_launch.figure_style import require_png, save_picture
from ddm_launch.interruption import Interrupted, raised_as_exception
from ddm_launch.programs import free_port, on_this_machine
from ddm_launch.run_folder import RunFolderError
from ddm_launch.step_runner import Failure
from ddm_launch.virtual_screen import VirtualScreen, missing_tools

WIDTH, HEIGHT = 1600, 900  # as in ddm.rviz
LIMIT_S = 120.0            # for rviz to show everything, once the trial is over


def like(red, green, blue):
    """Finds pixels of a colour, darker ones too: rviz lights its markers."""
    colour = np.array([red, green, blue], float) / max(red, green, blue)

    def share(pixels):
        brightness = pixels.max(axis=2, keepdims=True).astype(float)
        near = np.abs(pixels / np.maximum(brightness, 1.0) - colour).max(axis=2) < 0.2
        return np.mean(near & (brightness[..., 0] > 90))
    return share


def dark(pixels):
    return np.mean(pixels.max(axis=2) < 40)


def bright(pixels):
    return np.mean(pixels.min(axis=2) > 180)


def marks(pixels):
    """Of the learning curve: blue dots and red crosses."""
    return like(0, 114, 178)(pixels) + like(213, 94, 0)(pixels)


GREEN, CYAN, RED, YELLOW = like(0, 200, 0), like(0, 255, 255), like(255, 0, 0), like(255, 255, 0)

# Display: the middle of its place in the window (left, top, right, bottom), and the least share of its pixels that must
# be so.
DISPLAYS = {
    "Camera": ((60, 110, 410, 440), [(dark, 0.5), (bright, 0.005)]),
    "Learning curve": ((20, 530, 450, 870), [(bright, 0.5), (marks, 2e-4)]),
    "Feature space": ((1040, 90, 1580, 630), [(GREEN, 1e-3), (CYAN, 1e-4), (RED, 1e-4), (YELLOW, 1e-4)]),
    "Prediction": ((1040, 690, 1580, 870), [(dark, 0.3), (bright, 0.005)]),
    "Feature space in 3-D": ((500, 90, 1000, 860), [(GREEN, 1e-3), (CYAN, 5e-5), (RED, 5e-5), (YELLOW, 5e-5)]),
}


def missing_displays(pixels):
    """Names of the displays that do not show what they should."""
    missing = []
    for name, ((left, top, right, bottom), needs) in DISPLAYS.items():
        part = pixels[top:bottom, left:right]
        if any(measure(part) < least for measure, least in needs):
            missing.append(name)
    return missing


class Experiment:
    """experiment.launch with rviz on a screen, under a master of its own; a context."""

    def __init__(self, screen, scratch, arguments):
        environment = dict(os.environ, ROS_HOME=os.path.join(scratch, "ros"), PYTHONUNBUFFERED="1",
                           ROSCONSOLE_STDOUT_LINE_BUFFERED="1", **screen.environment)
        environment.pop("ROS_MASTER_URI", None)
        self._command = ["roslaunch", "-p", str(free_port()), "ddm_launch", "experiment.launch", "rviz:=true",
                         "runs:=" + os.path.join(scratch, "run")] + arguments
        self._environment = on_this_machine(environment)
        self.lines = []

    def __enter__(self):
        self._process = subprocess.Popen(self._command, env=self._environment, stdin=subprocess.DEVNULL,
                                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        return self

    def __exit__(self, *_):
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        self._process.wait()
        self._reader.join()

    def _read(self):
        for line in self._process.stdout:
            self.lines.append(line.rstrip())

    def require_running(self):
        if self._process.poll() is not None:
            raise Failure("the experiment ended too early:\n" + "\n".join(self.lines[-20:]))

    def has_finished(self, trial):
        return any(re.match(r"trial +%d/" % trial, line) for line in self.lines)


def screenshot(after_trial, seconds, arguments):
    """Pixels of the whole window, so many seconds after this trial, or a little later: when all displays are there."""
    with tempfile.TemporaryDirectory() as scratch, VirtualScreen(WIDTH, HEIGHT) as screen, \
            Experiment(screen, scratch, arguments) as experiment:
        while not experiment.has_finished(after_trial):
            experiment.require_running()
            time.sleep(0.1)
        time.sleep(seconds)
        end = time.monotonic() + LIMIT_S
        while True:
            experiment.require_running()
            pixels = screen.shoot()
            missing = missing_displays(pixels)
            if not missing:
                return pixels
            if time.monotonic() > end:
                raise Failure("rviz does not show within %g s: %s. Its last words:\n%s"
                              % (LIMIT_S, ", ".join(missing), "\n".join(experiment.lines[-20:])))


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="rviz_screenshot",
        description="Runs an experiment with rviz on a screen in memory (no monitor needed) and keeps a picture of the "
                    "window, as soon as each of its displays shows what it should.")
    parser.add_argument("--out", required=True, metavar="FILE.png", help="picture to write")
    parser.add_argument("--after-trial", type=int, default=5, metavar="K",
                        help="wait for the end of trial K, default 5")
    parser.add_argument("--seconds", type=float, default=2.0, metavar="S", help="and for S seconds more, default 2")
    parser.add_argument("launch", nargs="*", metavar="NAME:=VALUE", help="arguments of experiment.launch, after --")
    options = parser.parse_args(arguments)
    try:
        require_png(options.out)
        missing = missing_tools()
        if missing:
            raise Failure("these programs are missing: " + ", ".join(missing))
        with raised_as_exception():
            pixels = screenshot(options.after_trial, options.seconds, options.launch)
        save_picture(Image.fromarray(pixels).quantize(255, method=Image.MAXCOVERAGE), options.out, "PNG", optimize=True)
    except Interrupted as interruption:
        print("rviz_screenshot: %s" % interruption, file=sys.stderr)
        return 128 + interruption.number
    except (Failure, RunFolderError, OSError) as error:
        print("rviz_screenshot: %s" % error, file=sys.stderr)
        return 1
    print("wrote %s" % options.out)
    return 0
