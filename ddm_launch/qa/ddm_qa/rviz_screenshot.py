# Runs an experiment with the real rviz on a screen in memory and keeps a picture of the window.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import io
import os
import shutil
import subprocess
import tempfile
import time

import numpy as np
from PIL import Image

from ddm_launch.command import Failure, run_program
from ddm_launch.figure_style import require_png, save_picture
from ddm_launch.run_folder import num_finished
from ddm_qa.processes import start_roslaunch

WIDTH, HEIGHT = 1600, 900  # as in ddm.rviz
LIMIT_S = 120.0            # for rviz to show something everywhere, once the trial is over
TOOLS = {"Xvfb": "xvfb", "import": "imagemagick", "rviz": "rviz"}  # program: Debian's package

# Display: the middle of its place in the window (left, top, right, bottom).
DISPLAYS = {"Camera": (190, 110, 570, 440), "Learning curve": (150, 530, 600, 870),
            "Feature space": (950, 90, 1480, 630), "Prediction": (900, 690, 1500, 870)}


def blank_displays(pixels):
    """Names of the displays whose places are of one colour."""
    return [name for name, (left, top, right, bottom) in DISPLAYS.items()
            if pixels[top:bottom, left:right].std(axis=(0, 1)).max() < 1.0]


class VirtualScreen:
    """An X server that draws into memory; a context."""

    def __enter__(self):
        reading, writing = os.pipe()
        self._server = subprocess.Popen(  # it picks a free number by itself, and writes it when it is ready
            ["Xvfb", "-displayfd", str(writing), "-screen", "0", "%dx%dx24" % (WIDTH, HEIGHT), "-nolisten", "tcp"],
            pass_fds=[writing], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as stream:
            number = stream.readline().strip()
        if not number:
            raise Failure("Xvfb ended with code %d: try 'Xvfb :77' by hand" % self._server.wait())
        self._runtime = tempfile.TemporaryDirectory()
        self.environment = {"DISPLAY": ":" + number, "QT_X11_NO_MITSHM": "1", "XDG_RUNTIME_DIR": self._runtime.name}
        return self

    def __exit__(self, *_):
        self._server.terminate()
        self._server.wait()
        self._runtime.cleanup()

    def shoot(self):
        """All pixels: height x width x (red, green, blue)."""
        done = subprocess.run(["import", "-window", "root", "-depth", "8", "png:-"], stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=dict(os.environ, **self.environment))
        if done.returncode != 0:
            raise Failure("import (imagemagick) failed: %s" % done.stderr.decode(errors="replace").strip())
        return np.array(Image.open(io.BytesIO(done.stdout)).convert("RGB"))


def screenshot(after_trial, seconds, arguments):
    """Pixels of the whole window, so many seconds after this trial, or a little later: when no display is blank."""
    with tempfile.TemporaryDirectory() as scratch, VirtualScreen() as screen:
        runs, end, blank = os.path.join(scratch, "run"), None, []
        launch = start_roslaunch(os.path.join(scratch, "ros"), "experiment.launch", "rviz:=true", "runs:=" + runs,
                                 *arguments, variables=screen.environment)
        try:
            while launch.isRunning():
                time.sleep(0.1)
                if end is None and num_finished(runs) > after_trial:
                    time.sleep(seconds)
                    end = time.monotonic() + LIMIT_S
                if end is not None:
                    pixels = screen.shoot()
                    blank = blank_displays(pixels)
                    if not blank:
                        return pixels
                    if time.monotonic() > end:
                        raise Failure("rviz does not show within %g s: %s. Its last words:\n%s" % (
                            LIMIT_S, ", ".join(blank), launch.output[-2000:]))
            raise Failure("the experiment ended before %s. Its last words:\n%s" % (
                "rviz showed " + ", ".join(blank) if blank else "the end of trial %d" % after_trial, launch.output[-2000:]))
        finally:
            launch.stop()


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="rviz_screenshot",
        description="Runs an experiment with rviz on a screen in memory (no monitor needed) and keeps a picture of the "
                    "window, as soon as each of its displays shows something.")
    parser.add_argument("--out", required=True, metavar="FILE.png", help="picture to write")
    parser.add_argument("--after-trial", type=int, default=5, metavar="K",
                        help="wait for the end of trial K, default 5")
    parser.add_argument("--seconds", type=float, default=2.0, metavar="S", help="and for S seconds more, default 2")
    parser.add_argument("launch", nargs="*", metavar="NAME:=VALUE", help="arguments of experiment.launch, after --")
    options = parser.parse_args(arguments)

    def work():
        require_png(options.out)
        missing = ["%s (apt-get install %s)" % item for item in TOOLS.items() if not shutil.which(item[0])]
        if missing:
            raise Failure("these programs are missing: " + ", ".join(missing))
        pixels = screenshot(options.after_trial, options.seconds, options.launch)
        save_picture(Image.fromarray(pixels).quantize(255, method=Image.MAXCOVERAGE), options.out, "PNG", optimize=True)
        print("wrote %s" % options.out)
    return run_program("rviz_screenshot", work)
