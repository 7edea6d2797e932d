# What the tests of the figures share: a folder, files in it, a figure's program, stand-ins for the image programs.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import io
import os
import subprocess
import tempfile
import unittest

from PIL import Image
import roslib.packages

from ddm_launch import figure_style


class GreyCamera:
    """Stands in for the simulator where only the layout matters: the brightness tells the first number."""

    def __init__(self, _folder):
        pass

    def shoot(self, *state):
        return Image.new("L", (8, 8), round(state[0]) % 256)


class GreyDecoder:
    """Stands in for a model where only the layout matters: the brightness tells the place in the list, which may hold
    as many as a feature grid does."""

    def __init__(self, _model):
        self.features = []

    def decode(self, features):
        self.features = list(features)
        return [Image.new("L", (8, 8), 3 * k) for k in range(len(features))]


def make_run(folder):
    """A real run folder with a model that has learned next to nothing, in half a second: trial_000/model.ddm."""
    program = roslib.packages.find_node("ddm_launch", "run_experiment")[0]
    subprocess.run([program, "--preset", "debug", "--plant", "pendulum", "--seed", "1", "--trials", "0",
                    "--out", folder], stdout=subprocess.DEVNULL, check=True)
    return os.path.join(folder, "trial_000", "model.ddm")


class FigureCase(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name
        self.out = os.path.join(self.folder, "figure.png")

    def write(self, name, *lines):
        """Writes a text file into the folder of the test; returns its path."""
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as stream:
            stream.writelines(line + "\n" for line in lines)
        return path

    def callMain(self, main, *arguments):
        """Returns (exit code, what was written to stdout and stderr)."""
        with io.StringIO() as output, contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            try:
                code = main(list(arguments) + ["--out", self.out])
            except SystemExit as stop:
                code = stop.code
            return code, output.getvalue()

    def assertRefused(self, main, arguments, *parts):
        """The program ends with code 1, says all parts and draws nothing."""
        code, output = self.callMain(main, *arguments)
        self.assertEqual(code, 1, output)
        for part in parts:
            self.assertIn(part, output)
        self.assertFalse(os.path.exists(self.out))

    def assertDrawn(self, main, arguments, width):
        """The program draws a picture of this width [in] that is not blank and not too large for a repository."""
        code, output = self.callMain(main, *arguments)
        self.assertEqual((code, output), (0, "wrote %s\n" % self.out))
        self.assertLess(os.path.getsize(self.out), 200000)
        with Image.open(self.out) as picture:
            self.assertEqual(picture.width, round(width * figure_style.DPI))
            self.assertGreater(len(set(picture.convert("L").tobytes())), 10)


def drawn_points(axes, label):
    """Coordinates of what was scattered or drawn as a line under this label, as lists of pairs."""
    for collection in axes.collections:
        if collection.get_label() == label:
            return [tuple(point) for point in collection.get_offsets()]
    for container in axes.containers:
        if container.get_label() == label:
            return list(zip(*container.lines[0].get_data()))
    for line in axes.lines:
        if line.get_label() == label:
            return list(zip(*line.get_data()))
    raise AssertionError("nothing is drawn as '%s'" % label)
