# Gets descriptions and images of a plant from the program simulate.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile

import numpy as np
from PIL import Image
import yaml

from ddm_launch.command import Failure, find_program
from ddm_launch.run_folder import read_setting
from ddm_launch.tables import motors_of, read_table


def simulator(plant, *options):
    """Command line that runs a plant in the program simulate. Raises Failure if simulate is not built."""
    return [find_program("simulate", "ddm_sim"), "--plant", plant, *options]


def simulator_of(folder):
    """Command line that runs the plant of a run folder with the configuration of that folder."""
    return simulator(read_setting(folder, "experiment", "plant", "plant"), "--config", os.path.join(folder, "config.yaml"))


def describe_plant(command):
    """Returns the output of `simulate --describe` as a dictionary. command: result of simulator(). Raises Failure with
    the program's message if it fails."""
    done = subprocess.run(command + ["--describe"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)
    if done.returncode != 0:
        raise Failure("'%s' does not describe its plant: %s" % (" ".join(command), done.stderr.strip()))
    return yaml.safe_load(done.stdout)


def draw_images(command, start, motors, torques):
    """Simulates a plant and returns its grey images  [N + 1 x size x size]. start: initial state. torques: [N x
    motors].

    Raises Failure with the program's message if it fails.
    """
    lines = [",".join(motors)] + [",".join(repr(float(torque)) for torque in row) for row in torques]
    with tempfile.TemporaryDirectory() as folder:
        command = command + ["--frames", folder, "--start", ",".join(repr(float(value)) for value in start)]
        done = subprocess.run(command, input="\n".join(lines) + "\n", stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              universal_newlines=True)
        names = sorted(name for name in os.listdir(folder) if name.endswith(".png"))
        if done.returncode != 0 or not names:
            raise Failure("'%s' drew no image: %s" % (" ".join(command), done.stderr.strip()))
        images = []
        for name in names:
            with Image.open(os.path.join(folder, name)) as image:
                images.append(np.asarray(image.convert("L")))
        return np.array(images)


def draw_evaluation(run, trial):
    """Simulates an evaluation of a run folder again. Returns (rendered images, one per torque  [N x size x size];
    torques [N x motors]; names of the motors' columns). Raises Failure if the camera has lost frames, or if a file
    cannot be read."""
    folder, command = os.path.join(run, "evaluation_%03d" % trial), simulator_of(run)
    plant = describe_plant(command)
    trajectory = read_table(os.path.join(folder, "trajectory.csv"), "time_s", *plant["state"])
    if np.any(np.diff(trajectory.time_s) > 1.5 * plant["dt"]):
        raise Failure("in %s the camera has lost frames: only evaluations without camera/drop_rate can be drawn" % folder)
    motors = motors_of(os.path.join(folder, "torques.csv"))
    torques = read_table(os.path.join(folder, "torques.csv"), *motors)[motors].to_numpy(float)
    images = draw_images(command, trajectory[plant["state"]].iloc[0], motors, torques)
    return images[:len(torques)], torques, motors
