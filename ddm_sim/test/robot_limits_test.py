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
from process import Process, find_program  # noqa: E402
from robot_stand_in import LIMIT_S, RobotCase, wait_until  # noqa: E402

LIMITS = {"joints": ["arm"], "position_limits": [[-2.0, 2.0]], "speed_limit": [8.0]}


class Joints:
    """100 reports a second, of a gripper and an arm in two messages."""

    def __init__(self):
        self.position, self.velocity, self.reporting, self.age_s = 0.0, 0.0, True, 0.0
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
            self._publish("gripper", 99.0, 99.0)
            if self.reporting:
                self._publish("arm", self.position, self.velocity)
            time.sleep(0.01)


    def _publish(self, name, position, velocity):
        joints = JointState(name=[name], position=[position], velocity=[velocity])
        joints.header.stamp = rospy.Time.now() - rospy.Duration(self.age_s)
        self._publisher.publish(joints)


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


    def test_old_reports_bring_zero_torque(self):
        self.joints.age_s = 2.0
        self.robot.waitForEffort(0.0)
        refused = wait_until(lambda: self.robot.enable(True), "an answer")
        self.assertFalse(refused.success)
        self.assertRegex(refused.message, "joint arm .*differ by (1.9|2)")
        self.joints.age_s = 0.0
        self.robot.waitForEffort(2.0)

    def test_a_joint_that_stays_where_it_is_while_torques_change_is_reported(self):
        self.robot.controller.unregister()
        for torque in range(12):
            self.robot.answer(0.1 * torque)
        self.robot.process.waitForText("joint arm at exactly 0", LIMIT_S)
        self.robot.waitForEffort(0.1 * torque)

    def test_names_are_required_where_several_joints_have_limits(self):
        self.robot.process.stop()
        rospy.set_param("/robot_node/robot", {"position_limits": [[-1.0, 1.0], [-2.0, 2.0]]})
        process = Process([find_program("ddm_sim", "robot_node")])
        self.assertEqual(process.waitForEnd(LIMIT_S), 1)
        self.assertIn("robot/joints", process.output)


if __name__ == "__main__":
    rospy.init_node("robot_limits_test")
    rosunit.unitrun("ddm_sim", "robot_limits", RobotLimitsTest)
