#!/usr/bin/python3
# Tests of robot_node: reset, goal image, and refused requests.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import sys
import threading

import rospy
import rosunit
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Bool
from std_srvs.srv import Trigger, TriggerResponse

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from process import Process, find_program  # noqa: E402
from robot_case import LIMIT_S, Listener, RobotCase, wait_until  # noqa: E402


class RobotResetTest(RobotCase):
    def setUp(self):
        super().setUp()
        self.goal = self.file("goal.png")

    def offer(self, name, function):
        service = rospy.Service(name, Trigger, function)
        self.addCleanup(service.shutdown)

    def offerHanging(self, name):
        """Offers a service that does not answer until it is released. Returns the events of its call and of its release."""
        called, released = threading.Event(), threading.Event()
        self.addCleanup(released.set)

        def hang(_):
            called.set()
            released.wait(2.0 * LIMIT_S)  # longer than all waits of a test
            return TriggerResponse(success=True)

        self.offer(name, hang)
        return called, released

    def test_a_reset_asks_for_goal_start_and_motors_in_turn(self):
        robot = self.start("_robot/goal_file:=" + self.goal)
        self.assertFalse(robot.resetDone().success)  # no reset is waiting
        answer = robot.reset()
        robot.process.waitForText("take_goal", LIMIT_S)
        wait_until(lambda: robot.takeGoal().success, "a camera")
        wait_until(lambda: robot.goals.messages, "the goal")
        robot.camera.left = 0
        robot.process.waitForText("/reset_done", LIMIT_S)
        self.assertTrue(robot.resetDone().success)
        wait_until(lambda: re.search("waits: .*motors", robot.process.output), "a word on the motors")
        self.assertTrue(robot.enable(True).success)
        reset = answer()
        self.assertTrue(reset.success, reset.message)
        self.assertLess(abs((rospy.Time.now() - reset.start).to_sec()), LIMIT_S)
        wait_until(lambda: any(image.header.stamp > reset.start for image in robot.images.messages), "an image of the trial")
        self.assertEqual(list(bytearray(robot.goals.messages[0].data)), 4 * [255, 255, 0, 0])

    def test_the_service_of_the_user_has_the_motor_to_itself_once_the_motors_are_on(self):
        robot = self.start("_robot/reset_service:=go_home")
        wait_until(lambda: robot.takeGoal().success, "a camera")
        heard = []

        def goHome(_):
            before = len(robot.efforts.messages)
            rospy.sleep(0.2)
            heard.append(len(robot.efforts.messages) - before)
            return TriggerResponse(success=True)

        self.offer("go_home", goHome)
        answer = robot.reset()
        wait_until(lambda: re.search("waits: .*motors are off", robot.process.output), "a word on the motors")
        self.assertEqual(heard, [])
        self.assertTrue(robot.enable(True).success)
        reset = answer()
        self.assertTrue(reset.success, reset.message)
        self.assertLessEqual(heard[0], 2)  # a message may have been in transit
        self.assertEqual(robot.effort(), 0.0)

    def test_a_stop_takes_the_motor_from_the_service_of_the_user(self):
        robot = self.start("_robot/reset_service:=go_home")
        wait_until(lambda: robot.takeGoal().success, "a camera")
        enabled = Listener("motors_enabled", Bool)
        self.addCleanup(enabled.end)
        self.assertTrue(robot.enable(True).success)
        called, released = self.offerHanging("go_home")
        answer = robot.reset()
        self.assertTrue(called.wait(LIMIT_S))
        wait_until(lambda: enabled.messages[-1].data, "permission")
        self.assertTrue(robot.enable(False).success)
        robot.waitForEffort(0.0)
        wait_until(lambda: not enabled.messages[-1].data, "the end of the permission")
        refused = robot.enable(True)
        self.assertFalse(refused.success)
        self.assertIn("reset service", refused.message)
        released.set()
        self.assertIn("switched off", answer().message)
        self.assertTrue(robot.enable(True).success)
        self.assertTrue(robot.reset()().success)

    def test_what_does_not_come_in_time_is_named(self):
        robot = self.start("_robot/reset_service:=go_home", "_robot/reset_timeout:=0.8")
        self.assertIn("take_goal", robot.reset()().message)
        self.assertTrue(robot.takeGoal().success)
        self.assertIn("motors are off", robot.reset()().message)
        self.assertTrue(robot.enable(True).success)
        self.assertRegex(robot.reset()().message, "/go_home .*offered.*robot/reset_service")
        reasons = [""]
        self.offer("go_home", lambda _: TriggerResponse(success=False, message=reasons[0]))
        wait_until(lambda: "/go_home failed without a message" in robot.reset()().message, "the failure")
        reasons[0] = "the arm is stuck"
        wait_until(lambda: "the arm is stuck" in robot.reset()().message, "the reason")
        robot.camera.age_s = 5.0
        wait_until(lambda: "machine" in robot.reset()().message, "the reason")
        robot.camera.showing = False
        wait_until(lambda: "camera/source" in robot.reset()().message, "the reason")
        self.assertIn("camera/source", robot.takeGoal().message)

    def test_a_service_that_hangs_does_not_hang_the_reset(self):
        robot = self.start("_robot/reset_service:=go_home", "_robot/reset_timeout:=1.5")
        wait_until(lambda: robot.takeGoal().success, "a camera")
        self.assertTrue(robot.enable(True).success)
        called, _ = self.offerHanging("go_home")
        first = robot.reset()
        self.assertTrue(called.wait(LIMIT_S))
        self.assertIn("another reset", robot.reset()().message)
        self.assertRegex(first().message, "/go_home .*answer")
        wait_until(lambda: "reset service" in robot.process.output, "the motors are off")
        robot.answer(2.0)
        self.assertEqual(robot.effort(), 0.0)

    def test_another_form_of_images_is_named_with_the_remedy(self):
        robot = self.start("_robot/reset_timeout:=1.0")
        robot.camera.end()
        compressed = rospy.Publisher("camera/source/compressed", CompressedImage, queue_size=1)
        self.addCleanup(compressed.unregister)
        wait_until(lambda: re.search("CompressedImage.*republish compressed in:=/camera/source", robot.reset()().message), "a remedy")
        other = rospy.Publisher("camera/source", CompressedImage, queue_size=1)
        self.addCleanup(other.unregister)
        wait_until(lambda: "must be sensor_msgs/Image" in robot.reset()().message, "the type")

    def assertRefused(self, words, *arguments):
        if rospy.has_param("/refused"):
            rospy.delete_param("/refused")
        process = Process([find_program("ddm_sim", "robot_node"), "__name:=refused"] + list(arguments))
        self.assertEqual(process.waitForEnd(LIMIT_S), 1)
        self.assertIn(words, process.output)

    def test_the_goal_is_kept_in_its_file_and_one_that_cannot_be_used_is_refused(self):
        first = self.start("_robot/goal_file:=" + self.goal)
        wait_until(lambda: first.takeGoal().success, "a camera")
        first.end()
        second = self.start("_robot/goal_file:=" + self.goal)
        wait_until(lambda: second.goals.messages, "the goal")
        self.assertEqual(list(bytearray(second.goals.messages[0].data)), 4 * [255, 255, 0, 0])
        self.assertRefused("4x4 pixels", "_image/size:=5", "_robot/goal_file:=" + self.goal)
        self.assertRefused(os.path.abspath(__file__), "_robot/goal_file:=" + os.path.abspath(__file__))
        self.assertRefused("/camera/image_raw", "camera/source:=camera/image_raw")


if __name__ == "__main__":
    rospy.init_node("robot_reset_test")
    rosunit.unitrun("ddm_sim", "robot_reset", RobotResetTest)
