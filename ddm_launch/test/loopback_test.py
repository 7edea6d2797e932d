#!/usr/bin/python3
# A launch is reachable from this machine only, unless the environment says otherwise: its sockets are looked at.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import signal
import subprocess
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from namespaces import Network, why_not  # noqa: E402
from processes import Process, free_port, line_by_line  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

NODES = ["experiment_node", "model_node", "mpc_node", "sim_node", "trial_recorder", "view_node"]
LAUNCHERS = ["roslaunch", "rosmaster"]
LISTENS, UDP = "0A", "07"  # states in /proc/net
LOOPBACK, ANY = "0100007F", "00000000"  # addresses in /proc/net
LIMIT_S = 60.0
HINDRANCE = why_not("net", "mount")


def prefix():
    """The devel or install space that has the hook."""
    for folder in os.environ["CMAKE_PREFIX_PATH"].split(":"):
        if os.path.exists(os.path.join(folder, "etc", "catkin", "profile.d", "50.ddm_launch.sh")):
            return folder
    raise AssertionError("no workspace with the environment hook of ddm_launch is sourced")


def environment(**settings):
    """That of a user who has not sourced the workspace yet."""
    clean = {name: value for name, value in line_by_line().items()
             if name not in ("ROS_HOSTNAME", "ROS_IP", "ROS_MASTER_URI")}
    return dict(clean, **settings)


def children(process_id):
    """{name of the program: process id} of a process and all that it has started."""
    parents, names = {}, {}
    for path in glob.glob("/proc/[0-9]*/stat"):
        try:
            with open(path) as stream:
                before, after = stream.read().rsplit(")", 1)
            with open(os.path.dirname(path) + "/cmdline") as stream:
                words = stream.read().split("\0")
        except OSError:  # it has ended meanwhile
            continue
        number = int(before.split(" ", 1)[0])
        parents[number] = int(after.split()[1])
        program = words[1] if "python" in os.path.basename(words[0]) else words[0]
        names[number] = os.path.basename(program)
    family = {process_id}
    while True:
        more = {number for number, parent in parents.items() if parent in family} - family
        if not more:
            return {names[number]: number for number in family if number in names}
        family |= more


def addresses(process_id):
    """The addresses at which a process takes connections or datagrams, as /proc/net writes them."""
    inodes = set()
    for path in glob.glob("/proc/%d/fd/*" % process_id):
        try:
            inodes.add(os.readlink(path))
        except OSError:
            continue
    found = []
    for table, state in (("tcp", LISTENS), ("tcp6", LISTENS), ("udp", UDP), ("udp6", UDP)):
        with open("/proc/%d/net/%s" % (process_id, table)) as stream:
            for row in [line.split() for line in stream][1:]:
                if row[3] == state and "socket:[%s]" % row[9] in inodes:
                    found.append(row[1].split(":")[0])
    return found


class LoopbackTest(ScratchCase):
    def socketsOfALaunch(self, enter=(), **settings):
        """{program: its addresses} of an experiment that runs, started after sourcing the workspace. enter: words
        before a command that runs elsewhere."""
        source = '. "$0/setup.sh" && exec roslaunch "$@"'
        launch = Process(list(enter) + ["sh", "-c", source, prefix(), "-p", str(free_port()), "ddm_launch",
                                        "experiment.launch", "preset:=debug", "trials:=999", "view:=true",
                                        "runs:=" + self.file("runs")],
                         environment(ROS_HOME=self.scratch, **settings))
        self.addCleanup(launch.stop)
        launch.waitForText("trial  0/999", LIMIT_S)  # all have found each other
        found = {name: addresses(number) for name, number in children(launch.pid).items()}
        launch.send(signal.SIGINT)
        launch.waitForEnd(LIMIT_S)
        for name in NODES + LAUNCHERS:
            self.assertTrue(found.get(name), "%s listens nowhere: %s" % (name, found))
        return found

    def test_a_launch_listens_on_the_loopback_interface_only(self):
        found = self.socketsOfALaunch()
        found.pop("rosout")  # not ours: README, "Who can reach the nodes"
        for name, where in found.items():
            self.assertEqual(set(where), {LOOPBACK}, "%s: %s" % (name, where))

    @unittest.skipIf(HINDRANCE, "NO ADDRESS BUT THE LOOPBACK'S IS TESTED: %s" % HINDRANCE)
    def test_a_launch_that_is_told_its_address_listens_on_all_interfaces(self):
        network = Network()
        self.addCleanup(network.close)
        address, enter = network.addMachine([])
        found = self.socketsOfALaunch(enter, ROS_IP=address)
        for name in NODES + LAUNCHERS:
            self.assertEqual(set(found[name]), {ANY}, "%s: %s" % (name, found[name]))

    def test_sourcing_the_workspace_leaves_alone_what_the_environment_says(self):
        hook = os.path.join(prefix(), "etc", "catkin", "profile.d", "50.ddm_launch.sh")
        told = [({}, "127.0.0.1"), ({"ROS_IP": "10.0.0.2"}, "10.0.0.2"), ({"ROS_HOSTNAME": "robot"}, ""),
                ({"ROS_MASTER_URI": "http://localhost:11311"}, "127.0.0.1"),
                ({"ROS_MASTER_URI": "http://127.0.0.1:11311/"}, "127.0.0.1"),
                ({"ROS_MASTER_URI": "http://robot:11311"}, "")]
        for settings, address in told:
            done = subprocess.run(["sh", "-c", '. "$0"; printf %s "$ROS_IP"', hook], env=environment(**settings),
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(done.stdout, address, settings)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "loopback_test", LoopbackTest)
