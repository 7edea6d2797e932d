# Programs whose output is read while they run, and launches with masters of their own; every wait has a limit.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess
import threading

from ddm_qa.programs import free_port, on_this_machine


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
    def pid(self):
        return self._process.pid

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
        raise TimeoutError("'%s' did not come within %g s:\n%s" % (text, limit_s, self.output))

    def waitForEnd(self, limit_s):
        """The exit code."""
        try:
            code = self._process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.stop()
            raise TimeoutError("not at its end after %g s:\n%s" % (limit_s, self.output))
        if hasattr(self, "_reader"):
            self._reader.join(10.0)
        return code

    def isRunning(self):
        return self._process.poll() is None

    def send(self, signal_number):
        if self.isRunning():
            self._process.send_signal(signal_number)

    def stop(self, limit_s=20.0):
        """Ends the program, the hard way if need be."""
        self.send(signal.SIGINT)
        try:
            self._process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def start_roslaunch(log_folder, *arguments, port=None, folder=None, options=(), variables=None):
    """Starts `roslaunch ddm_launch ...` with a master of its own; port 0 joins the master that runs already.
    options: of roslaunch itself. variables: of its environment."""
    environment = dict(line_by_line(), ROS_HOME=log_folder, **(variables or {}))
    if folder:
        environment["PWD"] = folder  # as a shell would set it
    own_master = [] if port == 0 else ["-p", str(port or free_port())]
    if own_master:
        environment.pop("ROS_MASTER_URI", None)
    return Process(["roslaunch", *options] + own_master + ["ddm_launch"] + list(arguments),
                   on_this_machine(environment), folder)
