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


def output_of(command, limit_s=LIMIT_S, code=0, words=(), **kwargs):
    """Runs a program, which must end with this exit code and print these words. Returns its output."""
    found, output = call(command, limit_s, **kwargs)
    assert found == code and all(word in output for word in words), "%s\n%s" % (command, output)
    return output


def has_mujoco():
    """Whether ddm_sim was built with MuJoCo, which is not available on all systems."""
    code, output = call([find_program("simulate", "ddm_sim"), "--plant", "mujoco_pendulum", "--describe"])
    assert code == 0 or "libmujoco-dev" in output, output
    return code == 0


def output_of_main(main, arguments, code=0, words=()):
    """Calls the main function of a program in this process, with the same checks as output_of()."""
    with io.StringIO() as stream, contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
        try:
            found = main([str(word) for word in arguments])
        except SystemExit as stop:
            found = stop.code
        output = stream.getvalue()
    assert (found or 0) == code and all(word in output for word in words), output
    return output


def run_experiment(*arguments, **kwargs):
    return output_of([find_program("run_experiment"), *arguments], **kwargs)


def roslaunch(log_folder, *arguments, limit_s=LIMIT_S, **kwargs):
    """Runs a launch file of ddm_launch to its end. Returns the output."""
    launch = start_roslaunch(log_folder, *arguments, **kwargs)
    launch.waitForEnd(limit_s)
    return launch.output
