# What the tests of the figures share: files in a folder, a figure's program, stand-ins for the image programs.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

from PIL import Image
import roslib.packages

from ddm_launch import figure, figure_style
from processes import call_main
from scratch_case import ScratchCase


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


def call_figure(module, *arguments):
    """Draws a figure as its program does. Returns (exit code, output)."""
    name = module.__name__.split(".")[-1]
    return call_main(figure.program("figure", "", [module]), [name] + list(arguments))


class FigureCase(ScratchCase):
    def setUp(self):
        super().setUp()
        self.out = self.file("figure.png")

    def writeLines(self, name, *lines):
        """Writes a text file into the folder of this test. Returns its path."""
        return self.write(name, "".join(line + "\n" for line in lines))

    def callMain(self, module, *arguments):
        """Returns (exit code, output) of a figure that is drawn into self.out."""
        return call_figure(module, *arguments, "--out", self.out)

    def assertRefused(self, module, arguments, *parts):
        """The program ends with code 1, names all parts and draws nothing."""
        code, output = self.callMain(module, *arguments)
        self.assertEqual(code, 1, output)
        for part in parts:
            self.assertIn(part, output)
        self.assertFalse(os.path.exists(self.out))

    def assertDrawn(self, module, arguments, width):
        """The program draws a picture of this width [in] that is not blank and not too large for a repository."""
        code, output = self.callMain(module, *arguments)
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
