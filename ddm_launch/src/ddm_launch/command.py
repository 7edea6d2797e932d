# What the programs of ddm_launch share: how they fail, and where other programs and files are.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import math
import os
import platform
import sys

import roslib.packages

from ddm_launch.interruption import Interrupted, raised_as_exception


class Failure(Exception):
    """A program cannot go on. The message names the file or value at fault and the remedy."""

    exit_code = 1


def run_program(name, work):
    """Calls work() and returns its exit code. A failure or a signal is reported on stderr: 1, or 128 + the signal."""
    try:
        with raised_as_exception():
            return work() or 0
    except Interrupted as error:
        message, code = error, 128 + error.number
    except (Failure, OSError) as error:
        message, code = error, getattr(error, "exit_code", 1)
    print("%s: %s" % (name, message), file=sys.stderr)
    return code


def program_parser(name, about, epilog=None, **more):
    """Whose help keeps the lines of both texts."""
    return argparse.ArgumentParser(prog=name, description=about, epilog=epilog,
                                   formatter_class=argparse.RawDescriptionHelpFormatter, **more)


def number(kind, least, most=math.inf):
    """A type of argument: whole numbers (int) or any (float), from `least` to `most`."""
    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError("must be a %s >= %g%s, got '%s'" % (
                "whole number" if kind is int else "number", least, "" if most == math.inf else " and <= %g" % most, text))
        return value
    return parse


def find_program(name, package="ddm_launch"):
    """Path of a program. Raises Failure if it is not built."""
    found = roslib.packages.find_node(package, name)
    if not found:
        raise Failure("the program %s of %s is not there: build the workspace, then source its devel/setup.bash"
                      % (name, package))
    return found[0]


def package_path(*names, package="ddm_launch"):
    return os.path.join(roslib.packages.get_pkg_dir(package), *names)


def processor():
    """Name of this machine's processor."""
    try:
        with open("/proc/cpuinfo") as stream:
            return next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "?"
