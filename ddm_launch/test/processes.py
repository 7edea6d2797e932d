# Runs the programs of a workspace as a user would, with time limits.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import io

import rooms  # noqa: F401
from ddm_launch.command import find_program
from ddm_qa.processes import Process, free_port, line_by_line, start_roslaunch  # noqa: F401

LIMIT_S = 150.0  # time limit on a busy machine for a program that takes a few seconds on an idle one


def call(command, limit_s=LIMIT_S, **kwargs):
    """Runs a program to its end. Returns (exit code, output)."""
    process = Process(command, **kwargs)
    return process.waitForEnd(limit_s), process.output


def has_mujoco():
    """Whether ddm_sim was built with MuJoCo, which is not available on all systems."""
    code, output = call([find_program("simulate", "ddm_sim"), "--plant", "mujoco_pendulum", "--describe"])
    assert code == 0 or "libmujoco-dev" in output, output
    return code == 0


def call_main(main, *arguments):
    """Calls the main function of a program in this process. Returns (exit code, output)."""
    with io.StringIO() as output, contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        try:
            code = main(*arguments)
        except SystemExit as stop:
            code = stop.code
        return code, output.getvalue()


def run_experiment(*arguments, limit_s=LIMIT_S, **kwargs):
    return call([find_program("run_experiment")] + list(arguments), limit_s, **kwargs)


def roslaunch(log_folder, *arguments, limit_s=LIMIT_S, **kwargs):
    """Runs a launch file of ddm_launch to its end. Returns (exit code, output)."""
    launch = start_roslaunch(log_folder, *arguments, **kwargs)
    return launch.waitForEnd(limit_s), launch.output
