#!/usr/bin/python3
# robot_node: what the controller sees of a camera, and what the motor gets of its torques, over the wire.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess
import sys
import time

from ddm_msgs.msg import RunTrialActionResult, Torque
import rospy
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from process import Process  # noqa: E402
from robot_stand_in import DT, LIMIT_S, RobotCase, wait_until  # noqa: E402


# A controller in a process of its own: answers each image with the same torque.
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


class RobotMotorTest(RobotCase):
    def setUp(self):
        self.robot = self.start()

    def enterTrial(self, torque=2.0):
        self.assertTrue(self.robot.enable(True).success)
        self.robot.answerAll(torque)  # on a busy machine the first answer may be late
        self.robot.waitForEffort(torque)
        self.robot.controller.unregister()

    def test_images_are_cropped_small_and_grey_and_dt_apart(self):
        self.robot.camera.left = 200
        first = self.robot.images.next()
        images = [first] + [self.robot.images.next() for _ in range(4)]
        for image in images[1:]:
            self.assertEqual((image.width, image.height, image.encoding), (4, 4, "mono8"))
            self.assertEqual(list(bytearray(image.data)), 4 * [200, 200, 0, 0])  # 16 of 24 columns, then 16 black ones
        stamps = [image.header.stamp.to_sec() for image in images]
        for before, after in zip(stamps, stamps[1:]):
            self.assertGreater(after - before, 0.9 * DT)

    def test_the_motor_is_off_until_it_is_enabled_and_stops_at_once(self):
        self.robot.answer(2.0)
        self.assertEqual(self.robot.effort(), 0.0)
        self.enterTrial()
        self.robot.answerAll(2.0)  # or it would be zero soon anyway
        self.robot.waitForEffort(2.0)
        answer = self.robot.enable(False)
        self.assertTrue(answer.success)
        self.assertIn(" off", answer.message)
        self.robot.waitForEffort(0.0)  # an effort from before may overtake the answer
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
        self.robot.answer(2.0)
        self.assertEqual(self.robot.effort(), 0.0)

    def test_the_motor_gets_no_more_than_its_limit_and_zero_when_the_trial_ends(self):
        self.assertTrue(self.robot.enable(True).success)
        self.robot.answer(9.0)
        self.robot.waitForEffort(4.0)
        self.robot.trial_ends.publish(RunTrialActionResult())
        self.robot.waitForEffort(0.0)
        self.robot.images.next()
        self.robot.images.next()
        self.assertEqual(self.robot.numMisses(), 0)
        self.assertEqual(self.robot.cancels.messages, [])

    def test_a_late_torque_does_not_act_and_is_counted(self):
        self.enterTrial()
        self.robot.answer(3.0, delay_s=1.1 * DT)
        self.robot.waitForEffort(0.0)
        wait_until(lambda: self.robot.numMisses() >= 1, "a miss")
        self.assertNotIn(3.0, [message.data for message in self.robot.efforts.messages])
        wait_until(lambda: self.robot.latencies.messages[-1].data > 1.1 * DT, "a latency")
        self.assertLess(min(latency.data for latency in self.robot.latencies.messages), DT)
        self.robot.answer(1.0)  # ... and the next one in time does
        self.robot.waitForEffort(1.0)

    def test_of_each_image_it_is_published_which_torque_acted(self):
        lost = self.robot.images.next().header.stamp
        self.enterTrial()
        self.assertEqual(self.robot.appliedAt(self.robot.answer(9.0)), [4.0])  # as the motor has it
        self.assertEqual(self.robot.appliedAt(self.robot.answer(3.0, delay_s=1.1 * DT)), [])
        self.assertEqual(self.robot.appliedAt(lost), [])
        cut_short = self.robot.answer(2.0)
        self.robot.waitForEffort(2.0)
        self.robot.enable(False)
        self.assertEqual(self.robot.appliedAt(cut_short), [])
        self.enterTrial()
        self.robot.enable(False)
        self.assertEqual(self.robot.appliedAt(self.robot.answer(1.0)), [])

    def timeOfEffort(self, effort, since):
        """Monotonic time of the first one from a number of messages on."""
        efforts = self.robot.efforts

        def found():
            return [at for at, message in list(zip(efforts.times, efforts.messages))[since:] if message.data == effort]

        return wait_until(found, "effort %g" % effort)[0]

    def test_the_torque_is_zero_as_soon_as_the_controller_is_killed(self):
        self.robot.end()
        self.robot = self.start("_robot/max_hold:=5.0", dt=2.0)
        self.robot.torques.unregister()
        controller = Process([sys.executable, "-c", CONTROLLER])
        self.addCleanup(controller.stop)
        self.assertTrue(self.robot.enable(True).success)
        self.robot.waitForEffort(2.0)
        seen, killed = len(self.robot.efforts.messages), time.monotonic()
        controller.send(signal.SIGKILL)
        self.assertLess(self.timeOfEffort(0.0, seen) - killed, 0.5)  # dt is four times that
        self.robot.process.waitForText("no node publishes torques", LIMIT_S)

    def test_no_torque_is_held_for_longer_than_the_limit(self):
        self.robot.end()
        self.robot = self.start(dt=4.0)
        self.assertTrue(self.robot.enable(True).success)
        seen = len(self.robot.efforts.messages)
        stamp = self.robot.answer(2.0)
        acted_for = -self.timeOfEffort(2.0, seen)
        self.robot.waitForEffort(0.0)
        acted_for += self.robot.efforts.times[-1]
        self.assertGreater(acted_for, 0.4)
        self.assertLess(acted_for, 1.5)  # dt is 4 s
        self.assertEqual(self.robot.appliedAt(stamp), [])  # nothing is learned from an eighth of a step

    def test_without_a_subscriber_of_the_efforts_the_motors_are_off(self):
        self.enterTrial()
        self.robot.efforts.end()
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
        refused = self.robot.enable(True)
        self.assertFalse(refused.success)
        self.assertIn("effort controller", refused.message)

    def test_a_camera_that_changes_between_trials_is_refused(self):
        self.enterTrial()
        self.robot.trial_ends.publish(RunTrialActionResult())
        self.robot.camera.width = 64
        for words in ("48x40 rgb8", "64x40 rgb8"):
            self.robot.process.waitForText(words, LIMIT_S)
        self.robot.waitForEffort(0.0)
        self.assertIn("64x40 rgb8", self.robot.takeGoal().message)
        seen = len(self.robot.images.messages)
        self.robot.camera.width = 48
        wait_until(lambda: len(self.robot.images.messages) > seen, "an image")

    def test_the_torque_is_zero_when_the_camera_stops(self):
        self.enterTrial()
        self.robot.camera.showing = False
        self.robot.waitForEffort(0.0)
        wait_until(lambda: "zero torque: " in self.robot.process.output, "a warning")
        self.robot.camera.showing = True
        self.robot.answer(1.0)
        self.robot.waitForEffort(1.0)

    def test_a_torque_that_is_no_number_stops_the_motors_until_they_are_enabled_again(self):
        self.enterTrial()
        self.robot.answer(float("nan"))
        self.robot.waitForEffort(0.0)
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
        self.robot.answer(1.0)
        self.assertEqual(self.robot.effort(), 0.0)
        self.enterTrial(3.0)

    def test_a_torque_with_any_stamp_is_survived(self):
        self.enterTrial()
        for stamp in (rospy.Time(4294967295, 999999999), rospy.Time(0)):
            torque = Torque(torque=[3.0])
            torque.header.stamp = stamp
            self.robot.torques.publish(torque)
        wait_until(lambda: len(self.robot.latencies.messages) >= 3, "latencies")
        self.assertNotIn(3.0, [message.data for message in self.robot.efforts.messages])
        self.robot.answer(1.0)
        self.robot.waitForEffort(1.0)

    def test_a_trial_is_cancelled_where_the_motors_are_stopped_before_its_first_torque(self):
        self.assertTrue(self.robot.enable(True).success)
        self.assertTrue(self.robot.enable(False).success)
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")

    def test_a_trial_that_begins_while_the_motors_are_off_is_cancelled(self):
        self.robot.answer(2.0)
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")

    def test_two_publishers_of_torques_stop_the_motors_while_they_are_there(self):
        self.enterTrial()
        second = Process(["rostopic", "pub", "-r", "1", "torque", "ddm_msgs/Torque", "{torque: [1.0]}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("2 nodes", LIMIT_S)
        refused = self.robot.enable(True)
        self.assertFalse(refused.success)
        self.assertIn("2 nodes", refused.message)
        second.stop()
        wait_until(lambda: self.robot.enable(True).success, "one publisher")

    def endBy(self, signal_number):
        self.enterTrial()
        self.robot.process.send(signal_number)
        self.assertEqual(self.robot.process.waitForEnd(LIMIT_S), 0)
        wait_until(lambda: self.robot.efforts.messages[-1].data == 0.0, "zero")

    def test_the_last_word_to_the_motor_is_zero(self):
        self.endBy(signal.SIGINT)

    def test_the_last_word_is_zero_where_the_terminal_is_closed(self):
        self.endBy(signal.SIGHUP)

    def test_the_last_word_is_zero_where_somebody_quits(self):
        self.endBy(signal.SIGQUIT)

    def test_two_cameras_bring_zero_torque(self):
        self.robot.answerAll(2.0)
        self.assertTrue(self.robot.enable(True).success)
        self.robot.waitForEffort(2.0)
        second = Process(["rostopic", "pub", "-r", "1", "camera/source", "sensor_msgs/Image", "{}"])
        self.addCleanup(second.stop)
        self.robot.process.waitForText("2 nodes publish images there", LIMIT_S)
        self.robot.waitForEffort(0.0)
        second.stop()
        self.robot.waitForEffort(2.0)

    def test_the_last_word_is_zero_where_the_master_ends_the_node_too(self):
        self.enterTrial()
        subprocess.run(["rosnode", "kill", "/robot_node"], stdout=subprocess.DEVNULL, check=True, timeout=LIMIT_S)
        self.assertEqual(self.robot.process.waitForEnd(LIMIT_S), 0)
        wait_until(lambda: self.robot.efforts.messages[-1].data == 0.0, "zero")
        self.assertIn("user request", self.robot.process.output)


if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nodes inherit it, and nohup ignores it
    rospy.init_node("robot_motor_test")
    rosunit.unitrun("ddm_sim", "robot_motor", RobotMotorTest)
