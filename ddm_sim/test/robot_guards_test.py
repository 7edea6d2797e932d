#!/usr/bin/python3
# Tests of robot_node: joints beyond their limits, missing joint states, and a wrong clock of the camera.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import threading
import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import rospy
import rosunit
from sensor_msgs.msg import JointState

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from process import Process  # noqa: E402
from robot_case import LIMIT_S, Listener, RobotCase, SharedRobotCase, wait_until  # noqa: E402

CLOCK_DT = 0.1
HOUR_S = 3600.0
TRIES = 4
DELAY_LIMIT_S = 2.0 * CLOCK_DT + 0.05  # from the last valid image to the zero torque


class Joints:
    """Publishes 100 joint states per second, of a gripper and of an arm in two messages."""

    def __init__(self):
        self.position, self.reporting = 0.0, True
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
                self._publish("arm", self.position, 0.0)
            time.sleep(0.01)

    def _publish(self, name, position, velocity):
        joints = JointState(name=[name], position=[position], velocity=[velocity])
        joints.header.stamp = rospy.Time.now()
        self._publisher.publish(joints)


class RobotLimitsTest(SharedRobotCase):
    ROBOT = {"joints": ["arm"], "position_limits": [[-2.0, 2.0]], "speed_limit": [8.0]}

    @classmethod
    def setUpClass(cls):
        cls.joints = Joints()
        cls.addClassCleanup(cls.joints.end)
        super().setUpClass()

    def setUp(self):
        super().setUp()
        self.follow()

    def assertStopped(self, words):
        self.robot.waitForEffort(0.0)
        self.assertCancelled()
        self.assertNotEnabled(words)
        self.assertEqual(self.robot.effort(), 0.0)

    def test_a_joint_that_two_nodes_report_stops_the_motors(self):
        second = Process(["rostopic", "pub", "-r", "5", "joint_states", "sensor_msgs/JointState",
                          "{name: [arm], position: [0.0], velocity: [0.0]}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("reported on joint_states by", LIMIT_S)
        self.assertStopped("only its driver")

    def test_beyond_a_limit_the_motors_are_off_until_they_are_enabled(self):
        self.joints.position = -2.01
        self.assertStopped("robot/position_limits")
        self.joints.position = 0.0
        seen = len(self.robot.efforts.messages)
        for _ in range(2):
            self.robot.images.next()  # the controller answers this image
        self.assertEqual({message.data for message in self.robot.efforts.messages[seen:]}, {0.0})
        wait_until(lambda: self.robot.enable(True).success, "a report")
        self.robot.waitForEffort(2.0)

    def test_without_reports_the_torque_is_zero(self):
        self.joints.reporting = False
        self.robot.waitForEffort(0.0)
        self.assertNotEnabled("joint_states", "joint arm", "0.2 s")
        self.assertEqual(self.robot.cancels.messages, [])
        self.joints.reporting = True
        self.robot.waitForEffort(2.0)


class RobotClockTest(RobotCase):
    def setUp(self):
        self.robot = self.start(dt=CLOCK_DT)
        self.assertTrue(self.robot.enable(True).success)
        self.robot.answerAll(2.0)
        self.robot.waitForEffort(2.0)

    def zeroAfter(self, seen):
        """Returns the arrival of the first zero after `seen` efforts, or None."""
        efforts = self.robot.efforts
        return next((at for at, effort in list(zip(efforts.times, efforts.messages))[seen:] if effort.data == 0.0), None)

    def test_after_an_image_from_the_future_and_then_silence_the_motor_stops(self):
        delays = []
        for _ in range(TRIES):
            seen = len(self.robot.efforts.messages)
            last_good = self.robot.camera.end_with_image(-HOUR_S)
            delays.append(wait_until(lambda: self.zeroAfter(seen), "zero") - last_good)
            self.robot.camera.showing = True
            self.robot.waitForEffort(2.0)
        self.assertLessEqual(sorted(delays)[TRIES // 2], DELAY_LIMIT_S)  # a busy machine delays some of them
        self.assertLessEqual(max(delays), DELAY_LIMIT_S + 0.5)

    def refused(self):
        """Returns (level, number of refused images) of the last diagnosis."""
        for array in reversed(self.diagnoses.messages):
            for status in array.status:
                values = {value.key: value.value for value in status.values}
                if "images refused for their stamps" in values:
                    return status.level, int(values["images refused for their stamps"])
        return None, 0

    def test_a_clock_that_is_set_stops_the_motor_until_it_is_right_and_is_reported(self):
        self.diagnoses = Listener("/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnoses.end)
        for error_s in (HOUR_S, -HOUR_S):
            count = self.refused()[1]
            self.robot.camera.age_s = -error_s
            self.robot.waitForEffort(0.0)
            seen = len(self.robot.efforts.messages)
            wait_until(lambda: self.refused()[0] == DiagnosticStatus.ERROR and self.refused()[1] > count, "a diagnosis")
            self.assertEqual({message.data for message in self.robot.efforts.messages[seen:]}, {0.0})
            self.robot.camera.age_s = 0.0
            self.robot.waitForEffort(2.0)
        self.assertEqual(self.robot.cancels.messages, [])


if __name__ == "__main__":
    rospy.init_node("robot_guards_test")
    rosunit.unitrun("ddm_sim", "robot_guards", "__main__")
