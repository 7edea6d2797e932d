# Runs the programs of a workspace as a user would; every wait has a limit.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import socket
import subprocess
import threading

import roslib.packages


def find_program(package, name):
    """Path of a program of a package, in the devel or the install space."""
    paths = roslib.packages.find_node(package, name)
    if not paths:
        raise AssertionError("%s has no program %s: build the workspace first" % (package, name))
    return paths[0]


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


def line_by_line():
    """The environment in which ROS programs write each line at once, into a pipe too."""
    return dict(os.environ, PYTHONUNBUFFERED="1", ROSCONSOLE_STDOUT_LINE_BUFFERED="1")


class Process:
    """A program whose output, stdout and stderr together, is read while it runs."""

    def __init__(self, command, environment=None, folder=None, output=subprocess.PIPE, terminal=subprocess.DEVNULL):
        self._changed = threading.Condition()
        self._text = ""
        self._ended = False
        self._process = subprocess.Popen(
            [str(word) for word in command], env=environment or line_by_line(), cwd=folder, stdin=terminal,
            stdout=output, stderr=subprocess.STDOUT)
        if output == subprocess.PIPE:
            self._reader = threading.Thread(target=self._read, args=(self._process.stdout,), daemon=True)
            self._reader.start()

    def _read(self, stream):
        for line in iter(stream.readline, b""):
            with self._changed:
                self._text += line.decode(errors="replace")
                self._changed.notify_all()
        stream.close()
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    @property
    def output(self):
        with self._changed:
            return self._text

    def waitForText(self, text, limit_s):
        """Returns as soon as the output holds this text; fails if the program ends or time runs out before."""
        with self._changed:
            self._changed.wait_for(lambda: text in self._text or self._ended, limit_s)
            if text in self._text:
                return
        self.stop()
        raise AssertionError("'%s' did not come within %g s:\n%s" % (text, limit_s, self.output))

    def waitForEnd(self, limit_s):
        """The exit code."""
        try:
            code = self._process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.stop()
            raise AssertionError("not at its end after %g s:\n%s" % (limit_s, self.output))
        if hasattr(self, "_reader"):
            self._reader.join(10.0)
        return code

    def isRunning(self):
        return self._process.poll() is None

    def send(self, signal_number):
        if self.isRunning():
            self._process.send_signal(signal_number)

    def stop(self):
        """Ends the program, the hard way if need be."""
        self.send(signal.SIGINT)
        try:
            self._process.wait(20.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


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


def start_roslaunch(log_folder, *arguments, port=None, folder=None):
    """Starts `roslaunch ddm_launch ...` with a master of its own; port 0 joins the master that runs already."""
    environment = dict(line_by_line(), ROS_HOME=log_folder, ROS_HOSTNAME="localhost")
    if folder:
        environment["PWD"] = folder  # as a shell would set it
    own_master = [] if port == 0 else ["-p", str(port or free_port())]
    if own_master:
        environment.pop("ROS_MASTER_URI", None)
    return Process(["roslaunch"] + own_master + ["ddm_launch"] + list(arguments), environment, folder)


def roslaunch(log_folder, *arguments, limit_s=60.0, **kwargs):
    """Runs a launch file of ddm_launch to its end. Returns (exit code, output)."""
    launch = start_roslaunch(log_folder, *arguments, **kwargs)
    return launch.waitForEnd(limit_s), launch.output
