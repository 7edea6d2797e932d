# Programs whose output is read while they run or at their end, and launches with masters of their own. All have a limit.
# SPDX-License-Identifier: BSD-3-Clause
import os
import random
import signal
import socket
import subprocess
import threading
import urllib.parse
import xmlrpc.client

PORTS = range(12000, 32768)  # Linux gives none of them to programs that take any port


def free_port():
    """A port for a master. Nodes that start before the master do not take it."""
    while True:
        port = random.SystemRandom().choice(PORTS)
        with socket.socket() as sock:
            try:
                sock.bind(("localhost", port))
                return port
            except OSError:
                pass  # in use


def line_by_line():
    """The environment in which ROS programs write each line at once, into a pipe too."""
    return dict(os.environ, PYTHONUNBUFFERED="1", ROSCONSOLE_STDOUT_LINE_BUFFERED="1")


def on_this_machine(**variables):
    """The environment for a ROS master and nodes that only this machine can reach: ROS_IP=127.0.0.1. An environment that names
    an address (ROS_IP, ROS_HOSTNAME) or a master on another machine stays as it is. variables: of the environment."""
    environment = dict(line_by_line(), **variables)
    host = urllib.parse.urlparse(environment.get("ROS_MASTER_URI", "http://localhost")).hostname
    if not (environment.get("ROS_IP") or environment.get("ROS_HOSTNAME")) and host in ("localhost", "127.0.0.1"):
        environment["ROS_IP"] = "127.0.0.1"
    return environment


class Process:
    """A program whose output, stdout and stderr together, is read while it runs. As a context it ends the program."""

    def __init__(self, command, environment=None, folder=None, output=subprocess.PIPE):
        """output: a terminal that shows the output; then it is not read here."""
        self._changed = threading.Condition()
        self._text, self._ended = "", False
        self._process = subprocess.Popen(
            [str(word) for word in command], env=environment or line_by_line(), cwd=folder, stdin=subprocess.DEVNULL,
            stdout=output, stderr=subprocess.STDOUT)
        self._reader = threading.Thread(target=self._read, daemon=True)
        if output == subprocess.PIPE:
            self._reader.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def _read(self):
        with self._process.stdout as stream:
            for line in stream:
                with self._changed:
                    self._text += line.decode(errors="replace")
                    self._changed.notify_all()
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    @property
    def pid(self):
        return self._process.pid

    @property
    def output(self):
        return self._text

    def waitForText(self, text, limit_s):
        """Returns as soon as the output holds this text; fails if the program ends or time runs out before."""
        with self._changed:
            self._changed.wait_for(lambda: text in self._text or self._ended, limit_s)
        if text not in self._text:
            self.stop()
            raise TimeoutError("'%s' did not come within %g s:\n%s" % (text, limit_s, self.output))

    def waitForEnd(self, limit_s):
        """The exit code."""
        try:
            code = self._process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.stop()
            raise TimeoutError("not at its end after %g s:\n%s" % (limit_s, self.output))
        if self._reader.is_alive():
            self._reader.join(10.0)
        return code

    def isRunning(self):
        return self._process.poll() is None

    def send(self, signal_number):
        self._process.send_signal(signal_number)  # nothing if it has ended

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
    port = free_port() if port is None else port
    own_master = {"ROS_MASTER_URI": "http://localhost:%d" % port} if port else {}
    return Process(["roslaunch", *options, *(["-p", port] if port else []), "ddm_launch", *arguments],
                   on_this_machine(ROS_HOME=log_folder, **dict(variables or {}, **own_master)), folder)


def pid_of(master, node):
    """Process of a node on this machine, or of `master` itself. master: a rosgraph.Master."""
    if node == "master":
        return master.getPid()
    return xmlrpc.client.ServerProxy(master.lookupNode("/" + node.lstrip("/"))).getPid(master.caller_id)[2]
