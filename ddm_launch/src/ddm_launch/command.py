# Functions that the programs of ddm_launch share: failures, signals, arguments, and paths of programs and files.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import contextlib
import math
import os
import signal
import sys

import roslib.packages

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(BaseException):
    """A signal has asked the program to end. Derives from BaseException, so that no handler for Exception catches
    it."""

    def __init__(self, number):
        super().__init__("interrupted by %s" % signal.Signals(number).name)
        self.number = number


def _in_destructor(frame):
    """Whether this frame, or one that called it, is a destructor."""
    while frame and frame.f_code.co_name != "__del__":
        frame = frame.f_back
    return frame is not None


@contextlib.contextmanager
def raised_as_exception():
    """Context in which the first signal raises Interrupted in the main thread. Later signals are ignored and do not
    interrupt the clean-up."""
    def on_signal(number, frame):
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)
        # Python prints an exception that leaves a destructor, such as that of subprocess.Popen, and goes on. The alarm
        # therefore repeats the signal until it comes outside of a destructor.
        if _in_destructor(frame):
            signal.signal(signal.SIGALRM, lambda _, later: on_signal(number, later))
            signal.setitimer(signal.ITIMER_REAL, 0.01)
            return
        raise Interrupted(number)

    before = {number: signal.getsignal(number) for number in (*SIGNALS, signal.SIGALRM)}
    for number in SIGNALS:
        if number != signal.SIGHUP or before[number] != signal.SIG_IGN:  # nohup ignores SIGHUP
            signal.signal(number, on_signal)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)  # the program ended before a repeated signal came
        for number, handler in before.items():
            signal.signal(number, handler)


class Failure(Exception):
    """The program cannot continue. The message names the file or value that causes the failure, and the remedy."""

    exit_code = 1


class BadOptions(Failure):
    """The program refuses its options."""

    exit_code = 2


def run_program(name, work):
    """Calls work() and returns its exit code. Prints a failure or signal on stderr and returns 1, or 128 + the signal's
    number."""
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
    """Parser that expands `~` in `--out=~/x` and in quoted arguments such as `'~/x'`."""

    def parse_known_args(self, args=None, namespace=None):
        return super().parse_known_args([expand_home(word) for word in (sys.argv[1:] if args is None else args)], namespace)


def expand_home(word):
    """Expands `~` at the beginning of an argument, or after the equals sign of `--option=~/x`."""
    option, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
    return option + equals + os.path.expanduser(value)


def program_parser(name, about, epilog=None, **more):
    """Makes a parser whose help text keeps the line breaks of `about` and `epilog`."""
    return Parser(prog=name, description=about, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter, **more)


def number(kind, least):
    """Makes a type for argparse: finite numbers of the type `kind` (int or float) from `least` on."""
    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value < math.inf:
            raise argparse.ArgumentTypeError("must be a %s >= %g, got '%s'" % (
                "whole number" if kind is int else "number", least, text))
        return value
    return parse


def find_program(name, package="ddm_launch"):
    """Path of a program. Raises Failure if the program is not built."""
    found = roslib.packages.find_node(package, name)
    if not found:
        raise Failure("the program %s of %s is not there: build the workspace, then source its devel/setup.bash"
                      % (name, package))
    return found[0]


def package_path(*names):
    """Path of a file in the source folder of ddm_launch."""
    return os.path.join(roslib.packages.get_pkg_dir("ddm_launch"), *names)
