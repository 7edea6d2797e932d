# What a plant says of itself.
# SPDX-License-Identifier: BSD-3-Clause
import subprocess

import yaml

from ddm_launch.command import Failure, find_program


def simulator(plant, *options):
    """The command that runs a plant."""
    return [find_program("simulate", "ddm_sim"), "--plant", plant, *options]


def describe_plant(command):
    """What `simulate --describe` prints, {key: value}. command: of simulator(). Raises Failure with the program's words."""
    done = subprocess.run(command + ["--describe"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)
    if done.returncode != 0:
        raise Failure("'%s' does not describe its plant: %s" % (" ".join(command), done.stderr.strip()))
    return yaml.safe_load(done.stdout)
