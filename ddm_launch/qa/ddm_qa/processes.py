# Runs programs and launches with time limits, and reads their output while they run or at their end.
# SPDX-License-Identifier: BSD-3-Clause
import os
import random
import signal
import socket
import subprocess
import tempfile
import time
import urllib.parse
import xmlrpc.client

PORTS = range(12000, 32768)  # below Linux's range of ephemeral ports


def free_port():
    """Returns a free port for a master. Processes that start before the master do not get this port from Linux."""
    while True:
        port = random.SystemRandom().choice(PORTS)
        with socket.socket() as sock:
            try:
                sock.bind(("localhost", port))
                return port
            except OSError:
                pass  # the port is in use


def line_by_line():
    """Environment in which ROS programs write each line immediately, also into a pipe."""
    return dict(os.environ, PYTHONUNBUFFERED="1", ROSCONSOLE_STDOUT_LINE_BUFFERED="1")


def on_this_machine(**variables):
    """Environment for a ROS master and nodes that only this machine can reach (ROS_IP=127.0.0.1). Stays unchanged if it
    names an address (ROS_IP, ROS_HOSTNAME) or a master on another machine. variables: additional environment
    variables."""
    environment = dict(line_by_line(), **variables)
    host = urllib.parse.urlparse(environment.get("ROS_MASTER_URI", "http://localhost")).hostname
    if not (environment.get("ROS_IP") or environment.get("ROS_HOSTNAME")) and host in ("localhost", "127.0.0.1"):
        environment["ROS_IP"] = "127.0.0.1"
    return environment


class Process(subprocess.Popen):
    """A program whose output (stdout and stderr together) can be read while it runs. As a context manager it ends the
    program."""

    def __init__(self, command, environment=None, folder=None):
        self._file = tempfile.TemporaryFile()
        super().__init__([str(word) for word in command], env=environment or line_by_line(), cwd=folder,
                         stdin=subprocess.DEVNULL, stdout=self._file, stderr=subprocess.STDOUT)

    def __exit__(self, *_):
        self.stop()

    @property
    def output(self):
        return os.pread(self._file.fileno(), os.fstat(self._file.fileno()).st_size, 0).decode(errors="replace")

    def waitForText(self, text, limit_s):
        """Returns as soon as the output contains this text. Raises TimeoutError if the program ends or the time is over
        before."""
        end = time.monotonic() + limit_s
        while self.isRunning() and time.monotonic() < end and text not in self.output:
            time.sleep(0.02)
        if text not in self.output:
            self.stop()
            raise TimeoutError("'%s' did not come within %g s:\n%s" % (text, limit_s, self.output))

    def waitForEnd(self, limit_s):
        """Waits for the end and returns the exit code. Raises TimeoutError if the program does not end in time."""
        try:
            return self.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.stop()
            raise TimeoutError("not at its end after %g s:\n%s" % (limit_s, self.output)) from None

    def isRunning(self):
        return self.poll() is None

    def stop(self, limit_s=20.0):
        """Ends the program by SIGINT, and by SIGKILL if it does not end within the limit."""
        self.send_signal(signal.SIGINT)  # no effect if the program has ended
        try:
            self.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.kill()
            self.wait()


def start_roslaunch(log_folder, *arguments, port=None, folder=None, options=(), variables=None):
    """Starts `roslaunch ddm_launch ...` with its own master. Port 0 uses the master that is already running. options:
    options of roslaunch. variables: environment variables."""
    port = free_port() if port is None else port
    own_master = {"ROS_MASTER_URI": "http://localhost:%d" % port} if port else {}
    return Process(["roslaunch", *options, *(["-p", port] if port else []), "ddm_launch", *arguments],
                   on_this_machine(ROS_HOME=log_folder, **dict(variables or {}, **own_master)), folder)


def pid_of(master, node):
    """Process id of a node on this machine, or of the master if node is `master`. master: a rosgraph.Master."""
    if node == "master":
        return master.getPid()
    return xmlrpc.client.ServerProxy(master.lookupNode("/" + node.lstrip("/"))).getPid(master.caller_id)[2]
