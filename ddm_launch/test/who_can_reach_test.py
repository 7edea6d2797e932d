# Which sockets of a launch other machines reach: as doc/reference/network.md says, and none with its rule.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import signal
import subprocess
import sys
import unittest

from ddm_qa.processes import on_this_machine
from namespaces import Network, nft_rule, why_no_nft
from processes import Process, free_port, line_by_line
from run_files import expected_files, files_in
from scratch_case import ScratchCase

NODES = ["experiment_node", "model_node", "mpc_node", "sim_node", "trial_recorder", "view_node"]
LAUNCHERS = ["roslaunch", "rosmaster"]
LISTENS, UDP = "0A", "07"  # states in /proc/net
LOOPBACK, ANY = "0100007F", "00000000"  # addresses in /proc/net
LIMIT_S = 60.0
TRIALS = 15  # longer than a probe takes
HINDRANCE = why_no_nft()

# Prints the TCP ports, of those given, that take a connection; then sends a datagram to each UDP port.
PROBE = """
import socket, sys
from concurrent.futures import ThreadPoolExecutor
address, tcp, udp = sys.argv[1], sys.argv[2].split(","), sys.argv[3].split(",")
def connects(port):
    try:
        socket.create_connection((address, int(port)), 1.0).close()
        return True
    except OSError:
        return False
with ThreadPoolExecutor(len(tcp)) as pool:
    print(",".join(port for port, found in zip(tcp, pool.map(connects, tcp)) if found))
for port in udp:
    socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"?", (address, int(port)))
"""
# Counts the datagrams that get past the rule, and takes them: roscpp does not read what comes to a node's UDP port, and its
# thread for sockets runs without pause from then on.
COUNTER = """table inet test {
  chain input {
    type filter hook input priority 10; policy accept;
    iif != "lo" meta l4proto udp counter drop
  }
}
"""


def environment(**settings):
    """That of a user who has set nothing for ROS but what is given here."""
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


def sockets(process_id):
    """(protocol, address, port) of all sockets that take connections or datagrams; addresses as /proc/net has them."""
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
                    address, port = row[1].split(":")
                    found.append((table[:3], address, int(port, 16)))
    return found


class WhoCanReachTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.runs = self.file("runs")

    def startLaunch(self, trials, port, enter=(), **settings):
        """Returns an experiment whose nodes have all found each other. enter: words before a command that runs
        elsewhere."""
        launch = Process(list(enter) + ["roslaunch", "-p", str(port), "ddm_launch", "experiment.launch", "preset:=debug",
                                        "trials:=%d" % trials, "view:=true", "runs:=" + self.runs],
                         environment(ROS_HOME=self.scratch, **settings))
        self.addCleanup(launch.stop)
        launch.waitForText("trial  0/%d" % trials, LIMIT_S)
        return launch

    def socketsOf(self, launch):
        """{program: its sockets}"""
        found = {name: sockets(number) for name, number in children(launch.pid).items()}
        for name in NODES + LAUNCHERS + ["rosout"]:
            self.assertTrue(found.get(name), "%s listens nowhere: %s" % (name, found))
        return found

    def socketsOfALaunch(self, **settings):
        launch = self.startLaunch(999, free_port(), **settings)
        found = self.socketsOf(launch)
        launch.send(signal.SIGINT)
        launch.waitForEnd(LIMIT_S)
        return found

    def assertOnlyXmlRpcIsOpen(self, found, names):
        for name in names:
            self.assertEqual([socket[0] for socket in found[name] if socket[1] != LOOPBACK], ["tcp"], name)
            self.assertEqual(sorted(socket[0] for socket in found[name] if socket[1] == LOOPBACK), ["tcp", "udp"], name)

    def test_topics_and_services_of_a_plain_launch_keep_to_this_machine(self):
        found = self.socketsOfALaunch()
        self.assertOnlyXmlRpcIsOpen(found, NODES)
        for name in LAUNCHERS + ["rosout"]:
            self.assertIn(ANY, [socket[1] for socket in found[name]], name)

    def test_what_the_environment_says_is_left_alone(self):
        for told in ({"ROS_IP": "10.0.0.2"}, {"ROS_HOSTNAME": "robot"}, {"ROS_MASTER_URI": "http://robot:11311"}):
            self.assertEqual(on_this_machine(told), told)
        for told in ({}, {"ROS_MASTER_URI": "http://localhost:11311"}, {"ROS_MASTER_URI": "http://127.0.0.1:11311/"}):
            self.assertEqual(on_this_machine(told), dict(told, ROS_IP="127.0.0.1"))

    def reached(self, network, outside, inside, address, open_sockets):
        """(TCP ports of these sockets that take a connection from outside, number of datagrams that arrive)."""
        ports = {kind: sorted({str(socket[2]) for socket in open_sockets if socket[0] == kind})
                 for kind in ("tcp", "udp")}
        network.load(inside, COUNTER)
        done = subprocess.run(outside + [sys.executable, "-c", PROBE, address, ",".join(ports["tcp"]),
                                         ",".join(ports["udp"])], check=True, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, universal_newlines=True)
        table = subprocess.run(inside + ["nft", "list", "table", "inet", "test"], check=True, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, universal_newlines=True).stdout
        subprocess.run(inside + ["nft", "delete", "table", "inet", "test"], check=True)
        datagrams = int(table.split("counter packets ")[1].split()[0])
        return [port for port in done.stdout.strip().split(",") if port], datagrams

    @unittest.skipIf(HINDRANCE, "THE NFTABLES RULE IS NOT TESTED: %s" % HINDRANCE)
    def test_with_the_rule_of_the_page_nothing_is_reached_from_outside_and_the_experiment_finishes(self):
        network = Network()
        self.addCleanup(network.close)
        address, inside = network.addMachine([])
        _, outside = network.addMachine([])
        launch = self.startLaunch(TRIALS, 11311, inside, ROS_IP=address)  # the most open of all settings
        found = [socket for each in self.socketsOf(launch).values() for socket in each]
        self.assertEqual({socket[1] for socket in found}, {ANY})
        all_tcp = sorted({str(socket[2]) for socket in found if socket[0] == "tcp"})
        num_udp = len({socket[2] for socket in found if socket[0] == "udp"})
        self.assertGreaterEqual(len(all_tcp), 2 * len(NODES))
        self.assertGreaterEqual(num_udp, len(NODES))
        self.assertEqual(self.reached(network, outside, inside, address, found), (all_tcp, num_udp))  # the probe can succeed
        network.load(inside, nft_rule())
        self.assertEqual(self.reached(network, outside, inside, address, found), ([], 0))
        self.assertFalse(os.path.exists(os.path.join(self.runs, "summary.yaml")), "it was over before the probe")
        launch.waitForEnd(LIMIT_S)
        self.assertEqual(files_in(self.runs), expected_files(TRIALS), launch.output)
