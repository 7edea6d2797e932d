# Sockets of a launch that other machines can reach: those of doc/reference/network.md, and none with its rule.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import glob
import os
import re
import subprocess
import sys

import pytest

from namespaces import Network, nft_rule, why_no_nft
from processes import Process, free_port, line_by_line

NODES = ["experiment_node", "model_node", "mpc_node", "sim_node", "trial_recorder", "view_node"]
LAUNCHERS = ["roslaunch", "rosmaster", "rosout"]
LISTENS, UDP = "0A", "07"  # states in /proc/net
LOOPBACK, ANY = "0100007F", "00000000"  # addresses in /proc/net
HINDRANCE = why_no_nft()

# Prints which of the given TCP ports accept a connection.
PROBE = """
import socket, sys
for port in sys.argv[2:]:
    try:
        socket.create_connection((sys.argv[1], int(port)), 0.3).close()
        print(port)
    except OSError:
        pass
"""


def start_launch(folder, port, enter=(), **settings):
    """Starts an experiment with all nodes. The environment has no other settings for ROS. enter: words to put before a
    command that runs elsewhere."""
    clean = {name: value for name, value in line_by_line().items() if name not in ("ROS_HOSTNAME", "ROS_IP", "ROS_MASTER_URI")}
    return Process([*enter, "roslaunch", "-p", port, "ddm_launch", "experiment.launch", "preset:=debug", "trials:=999",
                    "view:=true", "runs:=%s/run" % folder], dict(clean, ROS_HOME=str(folder), **settings))


def family(process_id):
    """Returns {program name: process id} of a process and all its descendants."""
    found, todo = {}, [process_id]
    while todo:
        number = todo.pop()
        with open("/proc/%d/cmdline" % number) as stream:
            words = stream.read().split("\0")
        found[os.path.basename(words[1] if "python" in os.path.basename(words[0]) else words[0])] = number
        for path in glob.glob("/proc/%d/task/*/children" % number):
            with contextlib.suppress(FileNotFoundError), open(path) as stream:  # a thread may have ended meanwhile
                todo += [int(word) for word in stream.read().split()]
    return found


def sockets(process_id):
    """(protocol, address, port) of all sockets that accept connections or datagrams; addresses as in /proc/net."""
    inodes = {os.readlink(path) for path in glob.glob("/proc/%d/fd/*" % process_id) if os.path.islink(path)}
    found = []
    for table, state in (("tcp", LISTENS), ("tcp6", LISTENS), ("udp", UDP), ("udp6", UDP)):
        with open("/proc/%d/net/%s" % (process_id, table)) as stream:
            for row in [line.split() for line in stream][1:]:
                if row[3] == state and "socket:[%s]" % row[9] in inodes:
                    address, port = row[1].split(":")
                    found.append((table[:3], address, int(port, 16)))
    return found


def sockets_of(launch):
    """Returns {program: its sockets}."""
    launch.waitForText("trial  0/999", 120.0)
    found = {name: sockets(number) for name, number in family(launch.pid).items()}
    for name in NODES + LAUNCHERS:
        assert found.get(name), "%s listens nowhere: %s" % (name, found)
    return found


def test_topics_and_services_of_a_plain_launch_keep_to_this_machine(tmp_path):
    with start_launch(tmp_path, free_port()) as launch:
        found = sockets_of(launch)
    for name in NODES:  # only XML-RPC is reachable
        assert [socket[0] for socket in found[name] if socket[1] != LOOPBACK] == ["tcp"], name
        assert sorted(socket[0] for socket in found[name] if socket[1] == LOOPBACK) == ["tcp", "udp"], name
    for name in LAUNCHERS:
        assert ANY in [socket[1] for socket in found[name]], name


@pytest.mark.skipif(bool(HINDRANCE), reason="THE NFTABLES RULE IS NOT TESTED: %s" % HINDRANCE)
def test_with_the_rule_of_the_page_nothing_is_reached_from_outside_and_the_experiment_goes_on(tmp_path):
    with Network() as network:
        address, inside = network.addMachine([])
        _, outside = network.addMachine([])

        def reached():
            return sorted(subprocess.check_output([*outside, sys.executable, "-c", PROBE, address, *ports],
                                                  universal_newlines=True).split())

        with start_launch(tmp_path, 11311, inside, ROS_IP=address) as launch:  # the most open setting
            found = [socket for each in sockets_of(launch).values() for socket in each]
            ports = sorted({str(socket[2]) for socket in found if socket[0] == "tcp"})
            assert len(ports) >= 2 * len(NODES)
            assert reached() == ports  # the probe detects open ports
            network.load(inside, nft_rule())
            assert reached() == []
            trial = int(re.findall(r"trial +(\d+)/999", launch.output)[-1])
            launch.waitForText("trial %2d/999" % (trial + 2), 120.0)
