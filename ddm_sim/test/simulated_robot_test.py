#!/usr/bin/python3
# Test of a simulated robot with two motors: torques move the tile in both directions, as the images show.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import unittest

from ddm_msgs.msg import Torque
from ddm_msgs.srv import Reset
import rospy
import rosunit
from sensor_msgs.msg import Image, JointState
from std_srvs.srv import SetBool, Trigger

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_case import LIMIT_S, Listener, wait_until  # noqa: E402

MIDDLE = 25.5  # [pixels]
TORQUE = [1.0, -0.5]  # to the right and up [pixels per step]


def bright(image):
    """Returns (x, y) of the centre of the bright pixels [pixels]."""
    pixels = [divmod(i, image.width) for i, grey in enumerate(bytearray(image.data)) if grey > 160]
    return [0.5 + sum(pixel[axis] for pixel in pixels) / len(pixels) for axis in (1, 0)]


class SimulatedRobotTest(unittest.TestCase):
    def test_two_torques_move_the_tile_in_two_directions_until_they_end(self):
        images = Listener("camera/image_raw", Image)
        truth = Listener("plant/ground_truth/joint_states", JointState)
        torques = rospy.Publisher("torque", Torque, queue_size=10, tcp_nodelay=True)
        for service in ("take_goal", "enable", "reset"):
            rospy.wait_for_service(service, LIMIT_S)
        wait_until(lambda: rospy.ServiceProxy("take_goal", Trigger)().success, "a camera")
        wait_until(lambda: rospy.ServiceProxy("enable", SetBool)(True).success, "permission")  # all peers are there
        reset = rospy.ServiceProxy("reset", Reset)()
        self.assertTrue(reset.success, reset.message)
        self.assertEqual(list(truth.next().position), [MIDDLE, MIDDLE])
        for seen in bright(images.next()):
            self.assertAlmostEqual(seen, MIDDLE, delta=1.0)

        def answer(image):
            message = Torque(torque=TORQUE)
            message.header.stamp = image.header.stamp
            torques.publish(message)

        controller = rospy.Subscriber("camera/image_raw", Image, answer, tcp_nodelay=True)
        moved = wait_until(lambda: next((each for each in truth.messages if each.position[0] > MIDDLE + 8.0), None), "a movement")
        controller.unregister()
        self.assertEqual(list(moved.effort), TORQUE)
        self.assertAlmostEqual(moved.position[1] - MIDDLE, -0.5 * (moved.position[0] - MIDDLE), delta=1e-9)
        wait_until(lambda: list(truth.messages[-1].effort) == [0.0, 0.0], "zero for both motors")
        at_rest = list(truth.messages[-1].position)
        wait_until(lambda: all(abs(seen - there) < 1.0 for seen, there in zip(bright(images.next()), at_rest)),
                   "an image of the tile at %s" % at_rest)
        self.assertEqual(list(truth.messages[-1].position), at_rest)


if __name__ == "__main__":
    rospy.init_node("simulated_robot_test")
    rosunit.unitrun("ddm_sim", "simulated_robot", SimulatedRobotTest)
