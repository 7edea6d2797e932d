#!/usr/bin/python3
# Test of a slow subscriber: a recorder that is an episode behind the controller still receives every image.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os
import socket
import struct
import sys
import unittest
import xmlrpc.client

from ddm_msgs.msg import Torque
from ddm_msgs.srv import Reset
import rosgraph
from rosgraph.network import read_ros_handshake_header, write_ros_handshake_header
import rospy
import rosunit
from sensor_msgs.msg import Image

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_case import LIMIT_S, Listener, wait_until  # noqa: E402

TOPIC = "camera/image_raw"
NUM_STEPS = 200
SMALL = 4096  # buffer size for two images [bytes]
SEGMENT = 536  # smallest segment size of TCP, which limits the sender's buffer in the kernel [bytes]


class SlowReader:
    """A subscriber that leaves its connection unread until next() is called."""

    def __init__(self, topic):
        topic = rospy.resolve_name(topic)
        node = rosgraph.Master(rospy.get_name()).lookupNode(rospy.resolve_name("sim_node"))
        _, _, (_, host, port) = xmlrpc.client.ServerProxy(node).requestTopic("/slow_reader", topic, [["TCPROS"]])
        self._socket = socket.socket()
        self._socket.settimeout(LIMIT_S)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_MAXSEG, SEGMENT)
        self._socket.connect((host, port))
        write_ros_handshake_header(self._socket, {"callerid": "/slow_reader", "topic": topic, "md5sum": Image._md5sum,
                                                  "type": Image._type})
        read_ros_handshake_header(self._socket, io.BytesIO(), 1)  # one byte at a time, to leave the first image unread

    def _take(self, size):
        taken = b""
        while len(taken) < size:
            part = self._socket.recv(size - len(taken))
            if not part:
                raise ConnectionError("sim_node has closed the connection")
            taken += part
        return taken

    def next(self):
        size, = struct.unpack("<I", self._take(4))
        return Image().deserialize(self._take(size))

    def close(self):
        self._socket.close()


class SlowReaderTest(unittest.TestCase):
    def test_no_image_is_lost_when_a_reader_falls_behind(self):
        rospy.wait_for_service("reset", LIMIT_S)
        images = Listener(TOPIC, Image)
        torques = rospy.Publisher("torque", Torque, queue_size=10, tcp_nodelay=True)
        reader = SlowReader(TOPIC)
        self.addCleanup(reader.close)
        wait_until(lambda: images.connected() and torques.get_num_connections() == 1, "the connections")
        reset = rospy.ServiceProxy("reset", Reset)(num_steps=NUM_STEPS)
        self.assertTrue(reset.success, reset.message)
        for t in range(NUM_STEPS):
            wait_until(lambda: len(images.messages) > t, "image %d" % t)
            torque = Torque(torque=[1.0])
            torque.header.stamp = images.messages[t].header.stamp
            torques.publish(torque)
        self.assertEqual([reader.next().header.stamp for _ in range(NUM_STEPS)],
                         [image.header.stamp for image in images.messages])


if __name__ == "__main__":
    rospy.init_node("slow_reader_test")
    rosunit.unitrun("ddm_sim", "slow_reader", SlowReaderTest)
