#!/usr/bin/python3
# robot_node where nobody reads what it logs: a terminal that is stopped (Ctrl-S), a pager, a connection that hangs.
# SPDX-License-Identifier: BSD-3-Clause
import os
import select
import signal
import socket
import struct
import sys
import threading
import xmlrpc.client

import rosgraph
import rospy
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_case import LIMIT_S, RobotCase, wait_until  # noqa: E402


class StoppedTerminal:
    """A pipe that is full once stop() has returned."""

    def __init__(self):
        self.reader, self.writer = os.pipe()

    def stop(self):
        threading.Thread(target=self._fill, daemon=True).start()
        wait_until(lambda: not select.select([], [self.writer], [], 0)[1], "a full pipe")

    def _fill(self):
        try:
            while True:
                os.write(self.writer, 4096 * b"-")
        except OSError:  # it was closed
            pass

    def goOn(self):
        """Who waits can write and end."""
        os.close(self.writer)
        threading.Thread(target=self._drain, daemon=True).start()

    def _drain(self):
        with open(self.reader, "rb") as stream:
            stream.read()


class RobotTerminalTest(RobotCase):
    def setUp(self):
        self.terminal = StoppedTerminal()
        self.robot = self.start(written_to=self.terminal.writer)
        self.addCleanup(self.terminal.goOn)
        self.assertTrue(self.robot.enable(True).success)
        self.terminal.stop()
        self.robot.answer(2.0)  # from here on it has something to log
        self.robot.waitForEffort(2.0)

    def test_the_motor_stops_with_the_camera(self):
        self.robot.camera.showing = False
        self.robot.waitForEffort(0.0)

    def test_the_motor_stops_after_somebody_asked_for_a_topic_in_a_wrong_way(self):
        uri = rosgraph.Master("/robot_terminal_test").lookupNode("/robot_node")
        _, _, (_, host, port) = xmlrpc.client.ServerProxy(uri).requestTopic("/somebody", "/applied_torque", [["TCPROS"]])
        field = b"topic=/applied_torque"
        header = struct.pack("<I", len(field)) + field  # neither type nor md5sum: roscpp logs an error
        with socket.create_connection((host, port), LIMIT_S) as connection:
            connection.sendall(struct.pack("<I", len(header)) + header)
            connection.settimeout(LIMIT_S)
            self.assertIn(b"error", connection.recv(4096))
            self.robot.camera.showing = False
            self.robot.waitForEffort(0.0)

    def test_the_node_ends_and_its_last_word_is_zero(self):
        self.robot.process.send(signal.SIGINT)
        self.assertEqual(self.robot.process.waitForEnd(LIMIT_S), 0)  # it gives up on the terminal after ten seconds
        wait_until(lambda: self.robot.efforts.messages[-1].data == 0.0, "zero")


if __name__ == "__main__":
    rospy.init_node("robot_terminal_test")
    rosunit.unitrun("ddm_sim", "robot_terminal", RobotTerminalTest)
