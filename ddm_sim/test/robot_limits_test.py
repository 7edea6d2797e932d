#!/usr/bin/python3
# robot_node: what the motor gets when joints leave their limits, or nobody reports them.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import threading
import time

import rospy
import rosunit
from sensor_msgs.msg import JointState

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from process import Process  # noqa: E402
from robot_stand_in import LIMIT_S, RobotCase, wait_until  # noqa: E402

LIMITS = {"joints": ["arm"], "position_limits": [[-2.0, 2.0]], "speed_limit": [8.0]}


class Joints:
    """100 reports a second, of a gripper and an arm in two messages."""

    def __init__(self):
        self.position, self.velocity, self.reporting = 0.0, 0.0, True
        self._ended = False
        self._publisher = rospy.Publisher("joint_states", JointState, queue_size=10, tcp_nodelay=True)
        self._thread = threading.Thread(target=self._report, daemon=True)
        self._thread.start()

    def end(self):
        self._ended = True
        self._thread.join()
        self._publisher.unregister()

    def _report(self):
        while not self._ended:
            self._publisher.publish(JointState(name=["gripper"], position=[99.0], velocity=[99.0]))
            if self.reporting:
                self._publisher.publish(JointState(name=["arm"], position=[self.position], velocity=[self.velocity]))
            time.sleep(0.01)


class RobotLimitsTest(RobotCase):
    def setUp(self):
        self.joints = Joints()
        self.addCleanup(self.joints.end)
        self.robot = self.start(robot=LIMITS)
        wait_until(lambda: self.robot.enable(True).success, "a report")
        self.robot.answerAll(2.0)
        self.robot.waitForEffort(2.0)

    def assertStopped(self, words):
        self.robot.waitForEffort(0.0)
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
        refused = self.robot.enable(True)
        self.assertFalse(refused.success)
        self.assertIn(words, refused.message)
        self.assertEqual(self.robot.effort(), 0.0)

    def test_a_joint_that_two_nodes_report_stops_the_motors(self):
        second = Process(["rostopic", "pub", "-r", "5", "joint_states", "sensor_msgs/JointState", "{name: [arm], position: [0.0], velocity: [0.0]}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("reported on joint_states by", LIMIT_S)
        self.assertStopped("only its driver")

    def assertOnlyEnableHelps(self):
        seen = len(self.robot.efforts.messages)
        for _ in range(3):
            self.robot.images.next()  # which is answered
        self.assertEqual({message.data for message in self.robot.efforts.messages[seen:]}, {0.0})
        wait_until(lambda: self.robot.enable(True).success, "a report")
        self.robot.waitForEffort(2.0)

    def test_beyond_a_position_limit_the_motors_are_off_until_they_are_enabled(self):
        self.joints.position = -2.01
        self.assertStopped("robot/position_limits")
        self.joints.position = 0.0
        self.assertOnlyEnableHelps()

    def test_beyond_the_speed_limit_the_motors_are_off_until_they_are_enabled(self):
        for velocity in (-8.1, float("nan")):
            del self.robot.cancels.messages[:]
            self.joints.velocity = velocity
            self.assertStopped("robot/speed_limit")
            self.joints.velocity = 0.0
            self.assertOnlyEnableHelps()

    def test_without_reports_the_torque_is_zero(self):
        self.joints.reporting = False
        self.robot.waitForEffort(0.0)
        refused = self.robot.enable(True)
        self.assertFalse(refused.success)
        for word in ("joint_states", "joint arm", "0.2 s"):
            self.assertIn(word, refused.message)
        self.assertEqual(self.robot.cancels.messages, [])
        self.joints.reporting = True
        self.robot.waitForEffort(2.0)


if __name__ == "__main__":
    rospy.init_node("robot_limits_test")
    rosunit.unitrun("ddm_sim", "robot_limits", RobotLimitsTest)
