# rviz shows something in each of its displays during an experiment, on a virtual screen.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os
import subprocess
import time

import numpy as np
from PIL import Image
import pytest

from ddm_launch.run_folder import num_finished
from processes import start_roslaunch

WIDTH, HEIGHT = 1600, 900  # as in ddm.rviz
LIMIT_S = 120.0  # time limit for all displays after the end of a trial

# The centre region of each display in the window (left, top, right, bottom) [pixels].
DISPLAYS = {"Camera": (190, 110, 570, 440), "Learning curve": (150, 530, 600, 870),
            "Feature space": (950, 90, 1480, 630), "Prediction": (900, 690, 1500, 870)}


@pytest.fixture(name="screen")
def start_screen(tmp_path):
    """Starts an X server in memory. Returns the environment for programs that draw on it."""
    reading, writing = os.pipe()
    server = subprocess.Popen(  # the server chooses a free number and writes it when it is ready
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", "%dx%dx24" % (WIDTH, HEIGHT), "-nolisten", "tcp"],
        pass_fds=[writing], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as stream:
        number = stream.readline().strip()
    yield {"DISPLAY": ":" + number, "QT_X11_NO_MITSHM": "1", "XDG_RUNTIME_DIR": str(tmp_path)}
    server.terminate()
    server.wait()


def blank_displays(screen):
    """Names of the displays whose region on the screen has a single colour."""
    png = subprocess.check_output(["import", "-window", "root", "-depth", "8", "png:-"], env=dict(os.environ, **screen))
    pixels = np.array(Image.open(io.BytesIO(png)).convert("RGB"))
    assert pixels.shape == (HEIGHT, WIDTH, 3)
    return [name for name, (left, top, right, bottom) in DISPLAYS.items()
            if pixels[top:bottom, left:right].std(axis=(0, 1)).max() < 1.0]


def test_each_display_shows_something(screen, tmp_path):
    runs = str(tmp_path / "run")
    with start_roslaunch(str(tmp_path / "ros"), "experiment.launch", "rviz:=true", "preset:=debug", "trials:=999",
                         "runs:=" + runs, variables=screen) as launch:
        end, blank = time.monotonic() + LIMIT_S, list(DISPLAYS)
        while blank and launch.isRunning() and time.monotonic() < end:
            time.sleep(0.1)
            if num_finished(runs) > 1:
                blank = blank_displays(screen)
        assert not blank, launch.output[-2000:]
