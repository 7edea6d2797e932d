# Images that the C++ programs make: of a plant in a given state, and of features as a model decodes them.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile

from PIL import Image
import roslib.packages

from ddm_launch.run_folder import RunFolderError, read_plant, read_setting

TORQUE_COLUMNS = {"moving_tile": "dx_px,dy_px"}  # of the types of plants that do not turn a motor


def find_program(package, name):
    """Path of a program. Raises RunFolderError if it is not built."""
    programs = roslib.packages.find_node(package, name)
    if not programs:
        raise RunFolderError("the program '%s' of %s is not there: build the workspace, then source its "
                             "devel/setup.bash" % (name, package))
    return programs[0]


def draw_images(command, text):
    """The images that a program with the option --frames DIR draws when it is given this text.

    Returns grey PIL images, in order. Raises RunFolderError with the program's own words if it fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command + ["--frames", folder], input=text, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, universal_newlines=True)
        names = sorted(name for name in os.listdir(folder) if name.endswith(".png"))
        if done.returncode != 0 or not names:
            raise RunFolderError("'%s' drew no image: %s" % (" ".join(command), done.stderr.strip()))
        images = []
        for name in names:
            with Image.open(os.path.join(folder, name)) as image:
                images.append(image.convert("L"))
        return images


class Camera:
    """Images of a folder's plant in given states, drawn by the simulator with the folder's own configuration."""

    def __init__(self, folder):
        plant = read_plant(folder)
        self.command = [find_program("ddm_sim", "simulate"), "--plant", plant,
                        "--config", os.path.join(folder, "config.yaml")]
        self.header = TORQUE_COLUMNS.get(read_setting(folder, "plant", "type", "type of the plant"), "torque_nm")

    def shoot(self, *state):
        """The grey image of one state, e.g. angle [rad] and rate [rad/s] of the pendulum."""
        start = ",".join(repr(float(value)) for value in state)
        return draw_images(self.command + ["--start", start], self.header + "\n")[0]


class Decoder:
    """Images of features, decoded by a model."""

    def __init__(self, model):
        self.command = [find_program("ddm_model", "decode_features"), model]

    def decode(self, features):
        """One grey image for each feature (z_1, z_2, ...)."""
        header = ",".join("z_%d" % (i + 1) for i in range(len(features[0])))
        lines = [",".join(repr(float(value)) for value in feature) for feature in features]
        return draw_images(self.command, "\n".join([header] + lines) + "\n")
