#!/usr/bin/python3
# Tests of robot_node: images for the controller and torques for the motors.
# SPDX-License-Identifier: BSD-3-Clause
import os
import select
import signal
import subprocess
import sys
import threading
import time

from ddm_msgs.msg import RunTrialActionResult
import rospy
import rosunit
from std_msgs.msg import Float64

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from process import Process  # noqa: E402
from robot_case import DT, LIMIT_S, Listener, RobotCase, SharedRobotCase, wait_until  # noqa: E402


# A controller for a separate process, which answers each image with the same torque.
CONTROLLER = """
import rospy
from ddm_msgs.msg import Torque
from sensor_msgs.msg import Image

def answer(image):
    torque = Torque(torque=[2.0])
    torque.header.stamp = image.header.stamp
    torques.publish(torque)

rospy.init_node("controller")
torques = rospy.Publisher("torque", Torque, queue_size=10, tcp_nodelay=True)
rospy.Subscriber("camera/image_raw", Image, answer, tcp_nodelay=True)
rospy.spin()
"""


class RobotMotorTest(SharedRobotCase):
    def test_images_are_cropped_small_and_grey_and_dt_apart(self):
        self.robot.camera.left = 200
        self.robot.images.next()
        images = [self.robot.images.next() for _ in range(4)]
        for image in images:
            self.assertEqual((image.width, image.height, image.encoding), (4, 4, "mono8"))
            self.assertEqual(list(bytearray(image.data)), 4 * [200, 200, 0, 0])  # 16 of 24 columns, then 16 black ones
        stamps = [image.header.stamp.to_sec() for image in images]
        for before, after in zip(stamps, stamps[1:]):
            self.assertGreater(after - before, 0.9 * DT)

    def test_the_motor_is_off_until_it_is_enabled_and_stops_at_once(self):
        self.robot.answer(2.0)
        self.assertEqual(self.robot.effort(), 0.0)
        self.assertCancelled()  # the episode began while the motors were off
        del self.robot.cancels.messages[:]
        self.robot.enable(True)
        self.robot.answerAll(2.0)
        self.robot.waitForEffort(2.0)
        answer = self.robot.enable(False)
        self.assertTrue(answer.success)
        self.assertIn(" off", answer.message)
        self.robot.waitForEffort(0.0)  # an earlier effort may arrive after the answer
        self.assertCancelled()
        self.robot.answer(2.0)
        self.assertEqual(self.robot.effort(), 0.0)

    def test_the_motor_gets_no_more_than_its_limit_and_zero_when_the_trial_ends(self):
        self.assertTrue(self.robot.enable(True).success)
        num_misses = self.robot.numMisses()
        self.robot.answer(9.0)
        self.robot.waitForEffort(4.0)
        self.robot.trial_ends.publish(RunTrialActionResult())
        self.robot.waitForEffort(0.0)
        self.robot.images.next()
        self.robot.images.next()
        self.assertEqual(self.robot.numMisses(), num_misses)
        self.assertEqual(self.robot.cancels.messages, [])

    def test_of_each_image_it_is_published_which_torque_acted_and_a_late_one_does_not(self):
        lost = self.robot.images.next().header.stamp
        self.enterTrial()
        self.assertEqual(self.robot.appliedAt(self.robot.answer(9.0)), [4.0])  # after the saturation
        num_misses = self.robot.numMisses()
        self.assertEqual(self.robot.appliedAt(self.robot.answer(3.0, delay_s=1.1 * DT)), [])
        wait_until(lambda: self.robot.numMisses() > num_misses, "a miss")
        wait_until(lambda: self.robot.latencies.messages[-1].data > 1.1 * DT, "a latency")
        self.assertEqual(self.robot.appliedAt(lost), [])
        cut_short = self.robot.answer(2.0)
        self.robot.waitForEffort(2.0)
        self.robot.enable(False)
        self.assertEqual(self.robot.appliedAt(cut_short), [])

    def test_without_a_subscriber_of_the_efforts_the_motors_are_off(self):
        self.enterTrial()
        self.robot.efforts.end()
        self.assertCancelled()
        self.assertNotEnabled("effort controller")
        self.robot.efforts = Listener("effort_command", Float64)
        wait_until(self.robot.efforts.connected, "a connection")

    def test_a_camera_that_changes_between_trials_is_refused(self):
        self.enterTrial()
        self.robot.trial_ends.publish(RunTrialActionResult())
        self.robot.camera.width = 64
        for words in ("48x40 rgb8", "64x40 rgb8"):
            self.robot.process.waitForText(words, LIMIT_S)
        self.assertIn("64x40 rgb8", self.robot.takeGoal().message)

    def test_two_publishers_of_torques_stop_the_motors_while_they_are_there(self):
        self.enterTrial()
        second = Process(["rostopic", "pub", "-r", "1", "torque", "ddm_msgs/Torque", "{torque: [1.0]}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("2 nodes publish torques", LIMIT_S)
        self.assertNotEnabled("2 nodes")
        second.stop()
        wait_until(lambda: self.robot.enable(True).success, "one publisher")

    def test_two_cameras_bring_zero_torque(self):
        self.follow()
        second = Process(["rostopic", "pub", "-r", "1", "camera/source", "sensor_msgs/Image", "{}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("2 nodes publish images there", LIMIT_S)
        self.robot.waitForEffort(0.0)
        second.stop()
        self.robot.waitForEffort(2.0)


class RobotEndTest(RobotCase):
    def test_the_torque_is_zero_as_soon_as_the_controller_is_killed(self):
        robot = self.start("_robot/max_hold:=5.0", dt=2.0)
        robot.torques.unregister()
        controller = Process([sys.executable, "-c", CONTROLLER])
        self.addCleanup(controller.stop)
        self.assertTrue(robot.enable(True).success)
        robot.waitForEffort(2.0)
        seen, killed = len(robot.efforts.messages), time.monotonic()
        controller.send(signal.SIGKILL)

        def zeros():
            efforts = list(zip(robot.efforts.times, robot.efforts.messages))[seen:]
            return [at for at, effort in efforts if effort.data == 0.0]

        self.assertLess(wait_until(zeros, "zero")[0] - killed, 0.5)  # dt is four times that
        robot.process.waitForText("no node publishes torques", LIMIT_S)

    def test_the_last_message_to_each_motor_is_zero_however_the_node_is_ended(self):
        for number in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, None):
            robot = self.start(max_torque=[4.0, 2.0])
            self.assertTrue(robot.enable(True).success)
            robot.answer(9.0, -9.0)
            robot.waitForEffort((4.0, -2.0))  # each motor saturates at its own limit
            if number is None:
                subprocess.run(["rosnode", "kill", "/robot_node"], stdout=subprocess.DEVNULL, check=True, timeout=LIMIT_S)
            else:
                robot.process.send(number)
            self.assertEqual(robot.process.waitForEnd(LIMIT_S), 0)
            wait_until(lambda: robot.efforts.messages[-1].data == (0.0, 0.0), "zero")
            robot.end()
            self.assertTrue(number or "user request" in robot.process.output)

    def test_the_motor_stops_and_the_node_ends_where_its_roslaunch_is_killed_or_suspended(self):
        for number in (signal.SIGKILL, signal.SIGSTOP):
            robot = self.start(started_by=["sh", "-c", '"$@" & wait', "sh"])  # the shell stands for roslaunch
            self.assertTrue(robot.enable(True).success)
            robot.answer(2.0)
            robot.waitForEffort(2.0)
            robot.process.send(number)
            robot.process.waitForText("has ended or is suspended", LIMIT_S)
            wait_until(lambda: robot.efforts.messages[-1].data == 0.0, "zero")
            robot.process.send(signal.SIGKILL)
            robot.process.waitForEnd(LIMIT_S)  # of the node, too, which has the output of the shell
            robot.end()

    def test_the_motor_stops_with_the_camera_and_the_node_ends_where_nobody_reads_what_it_logs(self):
        """The pipe behaves like a terminal that is stopped (Ctrl-S), a pager, or a connection that hangs."""
        _, writer = os.pipe()
        robot = self.start(written_to=writer)
        self.assertTrue(robot.enable(True).success)
        threading.Thread(target=os.write, args=(writer, bytes(1 << 20)), daemon=True).start()  # fills the pipe
        wait_until(lambda: not select.select([], [writer], [], 0)[1], "a full pipe")
        robot.answer(2.0)  # causes log messages
        robot.waitForEffort(2.0)
        robot.camera.showing = False
        robot.waitForEffort(0.0)
        robot.process.send(signal.SIGINT)
        self.assertEqual(robot.process.waitForEnd(LIMIT_S), 0)  # at most ten seconds after the stop
        wait_until(lambda: robot.efforts.messages[-1].data == 0.0, "zero")


if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nodes inherit the handler, and nohup ignores the signal
    rospy.init_node("robot_motor_test")
    rosunit.unitrun("ddm_sim", "robot_motor", "__main__")
