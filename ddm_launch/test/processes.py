# Runs the programs of a workspace as a user would; every wait has a limit.
# SPDX-License-Identifier: BSD-3-Clause
import os

import roslib.packages

from ddm_launch.processes import Process, line_by_line, start_roslaunch  # noqa: F401
from ddm_launch.programs import free_port  # noqa: F401


def find_program(package, name):
    """Path of a program of a package, in the devel or the install space."""
    paths = roslib.packages.find_node(package, name)
    if not paths:
        raise AssertionError("%s has no program %s: build the workspace first" % (package, name))
    return paths[0]


def call(command, limit_s=60.0, **kwargs):
    """Runs a program to its end. Returns (exit code, output)."""
    process = Process(command, **kwargs)
    return process.waitForEnd(limit_s), process.output


def run_experiment(*arguments, limit_s=60.0, **kwargs):
    return call([find_program("ddm_launch", "run_experiment")] + list(arguments), limit_s, **kwargs)


def run_both_drivers(scratch, seed, trials, arguments, config=None):
    """One experiment by the nodes and by run_experiment: preset, plant or nuisance by name in `arguments`, and the
    text of a further file. Returns their folders and their outputs, the nodes' first."""
    arguments = dict(arguments, seed=seed, trials=trials)
    if config:
        arguments["config"] = os.path.join(scratch, "config.yaml")
        with open(arguments["config"], "w") as stream:
            stream.write(config)
    nodes, process = os.path.join(scratch, "nodes"), os.path.join(scratch, "process")
    _, nodes_output = roslaunch(scratch, "experiment.launch", "runs:=" + nodes,
                                *["%s:=%s" % item for item in arguments.items()])
    _, process_output = run_experiment("--out", process,
                                       *[word for key, value in arguments.items() for word in ("--" + key, value)])
    return (nodes, process), (nodes_output, process_output)


def roslaunch(log_folder, *arguments, limit_s=60.0, **kwargs):
    """Runs a launch file of ddm_launch to its end. Returns (exit code, output)."""
    launch = start_roslaunch(log_folder, *arguments, **kwargs)
    return launch.waitForEnd(limit_s), launch.output
