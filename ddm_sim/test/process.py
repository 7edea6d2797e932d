# Runs a program and reads its output while it runs; every wait has a time limit.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess
import threading

import roslib.packages


def find_program(package, name):
    """Returns the path of a program of a package in the devel or the install space."""
    paths = roslib.packages.find_node(package, name)
    assert paths, "%s has no program %s: build the workspace first" % (package, name)
    return paths[0]


class Process:
    """A running program. `output` contains its stdout and stderr, unless they go to the file `written_to`."""

    def __init__(self, command, written_to=None):
        self.output = ""
        self._changed, self._ended = threading.Condition(), False
        environment = dict(os.environ, PYTHONUNBUFFERED="1", ROSCONSOLE_STDOUT_LINE_BUFFERED="1")
        self._process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=written_to or subprocess.PIPE,
                                         stderr=subprocess.STDOUT, universal_newlines=True, errors="replace")
        self._reader = threading.Thread(target=self._read, args=(self._process.stdout or [],), daemon=True)
        self._reader.start()

    def _read(self, lines):
        for line in lines:
            with self._changed:
                self.output += line
                self._changed.notify_all()
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def waitForText(self, text, limit_s):
        """Waits until the output contains this text; fails if the program ends or the limit passes before."""
        with self._changed:
            self._changed.wait_for(lambda: text in self.output or self._ended, limit_s)
            if text not in self.output:
                raise TimeoutError("'%s' did not come within %g s:\n%s" % (text, limit_s, self.output))

    def waitForEnd(self, limit_s):
        """Waits for the end of the program and returns its exit code."""
        code = self._process.wait(limit_s)
        self._reader.join(limit_s)
        return code

    def send(self, signal_number):
        self._process.send_signal(signal_number)  # no effect if the program has ended

    def stop(self, limit_s=20.0):
        """Ends the program by SIGINT, or by SIGKILL if it does not end within the limit."""
        self.send(signal.SIGINT)
        try:
            self._process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
