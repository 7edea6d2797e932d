# A screen without a monitor, and pictures of what programs show on it.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os
import shutil
import subprocess
import tempfile

import numpy as np
from PIL import Image

from ddm_launch.step_runner import Failure

TOOLS = {"Xvfb": "xvfb", "import": "imagemagick", "rviz": "rviz"}  # program: Debian's package


def missing_tools():
    """What is not installed of all that a picture of rviz needs, in words."""
    return ["%s (apt-get install %s)" % (tool, package) for tool, package in TOOLS.items() if not shutil.which(tool)]


class VirtualScreen:
    """An X server that draws into memory; a context."""

    def __init__(self, width, height):
        self.size = "%dx%dx24" % (width, height)

    def __enter__(self):
        reading, writing = os.pipe()
        self._server = subprocess.Popen(  # it picks a free number by itself, and tells it when it is ready
            ["Xvfb", "-displayfd", str(writing), "-screen", "0", self.size, "-nolisten", "tcp"], pass_fds=[writing],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
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
