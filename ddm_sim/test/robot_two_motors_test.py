#!/usr/bin/python3
# robot_node with two motors: what JointGroupEffortController of ros_control gets.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rospy
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_stand_in import RobotCase, wait_until  # noqa: E402

ZERO = (0.0, 0.0)


class RobotTwoMotorsTest(RobotCase):
    def setUp(self):
        self.robot = self.start(max_torque=[4.0, 2.0])
        self.assertTrue(self.robot.enable(True).success)
        self.robot.answer(3.0, -1.0)
        self.robot.waitForEffort((3.0, -1.0))

    def test_each_motor_has_its_own_limit(self):
        stamp = self.robot.answer(9.0, -9.0)
        self.robot.waitForEffort((4.0, -2.0))
        self.assertEqual(self.robot.appliedAt(stamp), [4.0, -2.0])

    def test_both_torques_are_zero_after_silence(self):
        self.robot.camera.showing = False
        self.robot.waitForEffort(ZERO)
        self.assertEqual(self.robot.cancels.messages, [])

    def test_a_torque_of_the_wrong_length_stops_both_motors(self):
        self.robot.answer(3.0)
        self.robot.waitForEffort(ZERO)
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
        self.robot.answer(3.0, -1.0)
        self.assertEqual(self.robot.effort(), ZERO)

    def test_both_torques_are_zero_when_the_node_ends(self):
        self.robot.process.stop()
        wait_until(lambda: self.robot.efforts.messages[-1].data == ZERO, "zero")


if __name__ == "__main__":
    rospy.init_node("robot_two_motors_test")
    rosunit.unitrun("ddm_sim", "robot_two_motors", RobotTwoMotorsTest)
