# Runs programs to their end, one at a time, on one core each and with masters of their own: what is timed.
# SPDX-License-Identifier: BSD-3-Clause
import os
import socket
import subprocess
import urllib.parse

from ddm_launch.command import Failure

LIMIT_S = 900.0


def free_port():
    with socket.socket() as sock:
        sock.bind(("localhost", 0))
        return sock.getsockname()[1]


def on_this_machine(environment):
    """The environment for a ROS master and nodes that only this machine can reach: ROS_IP=127.0.0.1. One that names an
    address (ROS_IP, ROS_HOSTNAME) or a master on another machine is left as it is."""
    host = urllib.parse.urlparse(environment.get("ROS_MASTER_URI", "http://localhost")).hostname
    if environment.get("ROS_IP") or environment.get("ROS_HOSTNAME") or host not in ("localhost", "127.0.0.1"):
        return environment
    return dict(environment, ROS_IP="127.0.0.1")


class Programs:
    def __init__(self, scratch):
        """scratch: folder for the logs of nodes."""
        self.scratch = scratch

    def call(self, what, command, **variables):
        """Returns what a program printed. variables: of its environment. Raises Failure with its last words."""
        environment = on_this_machine(dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", **variables))
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  universal_newlines=True, timeout=LIMIT_S, env=environment)
        except subprocess.TimeoutExpired:
            raise Failure("%s: '%s' has not ended within %g s" % (what, " ".join(command), LIMIT_S)) from None
        if done.returncode != 0:
            raise Failure("%s: '%s' failed with code %d:\n%s" % (
                what, " ".join(command), done.returncode, (done.stderr or done.stdout)[-2000:].strip()))
        return done.stdout

    def roslaunch(self, what, *arguments):
        """roslaunch returns 0 whatever happens: what its nodes leave behind is the verdict."""
        port = free_port()
        self.call(what, ["roslaunch", "-p", str(port)] + list(arguments), ROS_HOME=os.path.join(self.scratch, "ros"),
                  ROS_MASTER_URI="http://localhost:%d" % port)
