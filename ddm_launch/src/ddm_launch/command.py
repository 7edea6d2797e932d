# What the programs of ddm_launch share: failures, signals, arguments, and the paths of other programs and files.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import contextlib
import math
import os
import platform
import signal
import sys

import roslib.packages

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(BaseException):
    """A signal asks to end. Not an Exception: nothing but the program itself may handle it."""

    def __init__(self, number):
        super().__init__("interrupted by %s" % signal.Signals(number).name)
        self.number = number


@contextlib.contextmanager
def raised_as_exception():
    """In this context the first signal raises Interrupted in the main thread. Later signals are ignored, so that they do
    not interrupt the clean-up."""
    def on_signal(number, _):
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)
        raise Interrupted(number)

    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        if number != signal.SIGHUP or before[number] != signal.SIG_IGN:  # under nohup a lost terminal is not a reason
            signal.signal(number, on_signal)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def held_back():
    """In this context signals wait. For steps that must not be interrupted between them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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


class Parser(argparse.ArgumentParser):
    """Reads `--out=~/x` and `'~/x'` as a shell reads `~/x`."""

    def parse_known_args(self, args=None, namespace=None):
        return super().parse_known_args([expand_home(word) for word in (sys.argv[1:] if args is None else args)], namespace)


def expand_home(word):
    option, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
    return option + equals + os.path.expanduser(value)


def program_parser(name, about, epilog=None, **more):
    """A parser whose help keeps the line breaks of both texts."""
    return Parser(prog=name, description=about, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter, **more)


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


def processor(path="/proc/cpuinfo"):
    """This machine's processor: its name, and the family and model that tell apart generations of one name."""
    try:
        with open(path) as stream:
            first = stream.read().split("\n\n")[0]
        facts = {name.strip(): value.strip() for name, _, value in (line.partition(":") for line in first.splitlines())}
        name = facts["model name"]
    except (OSError, KeyError):
        return platform.processor() or "?"
    if "cpu family" in facts and "model" in facts:
        name += " (family %s, model %s)" % (facts["cpu family"], facts["model"])
    return name


def distribution(path="/etc/os-release"):
    """Name of the distribution, whose compiler and libraries made the programs."""
    try:
        with open(path) as stream:
            return dict(line.rstrip("\n").split("=", 1) for line in stream if "=" in line)["PRETTY_NAME"].strip('"')
    except (OSError, KeyError):
        return "?"
