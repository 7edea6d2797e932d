#!/usr/bin/python3
# Whole experiments on a robot: robot_check.launch, stopped and resumed, and the rehearsal of the tutorial.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import time

import rosbag
import rosgraph
import rospy
import rosunit
from sensor_msgs.msg import Image
from std_msgs.msg import Float64, Header
from std_srvs.srv import SetBool, Trigger

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import roslaunch, start_roslaunch  # noqa: E402
from run_files import files_in, read_bag, read_bytes, read_rows, read_yaml  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

STEPS, DT = 30, 0.1
LIMIT_S = 120.0


class RobotLoopTest(ScratchCase):
    def test_an_experiment_on_a_robot_is_stopped_and_resumed_with_another_crop(self):
        """As the tutorial says: crop and goal_distance are chosen by looking, until the first trial is finished."""
        arguments = ["robot_check.launch", "preset:=debug", "trials:=0", "dt:=%g" % DT, "load:=false", "runs:=" + self.out]
        launch = start_roslaunch(self.scratch, *arguments, "crop:=10,10,180,180", "goal_distance:=0.5",
                                 port=0)  # on the master of this test
        self.addCleanup(launch.stop)
        launch.waitForText("motors follow", LIMIT_S)
        self.assertTrue(rospy.ServiceProxy("enable", SetBool)(False).success)
        launch.waitForEnd(LIMIT_S)
        self.assertIn("cancelled", launch.output)
        self.assertIn("resumes", launch.output)
        self.assertNotIn("summary.yaml", files_in(self.out))

        _, output = roslaunch(self.scratch, *arguments, limit_s=LIMIT_S)
        self.assertTrue(os.path.exists(os.path.join(self.out, "summary.yaml")), output)
        self.checkRobotRun()

        rows = read_bytes(self.out, "trials.csv")
        _, output = roslaunch(self.scratch, *arguments, "crop:=10,10,180,180", limit_s=LIMIT_S)
        self.assertRegex(output, r"robot/crop: \[5, 5, 190, 190\] there, \[10, 10, 180, 180\] here, .*first trial")
        self.assertEqual(read_bytes(self.out, "trials.csv"), rows)

    def checkRobotRun(self):
        self.assertEqual(files_in(self.out), sorted(
            [".trials.crc32", "config.yaml", "robot_check.yaml", "summary.yaml", "trials.csv",
             "evaluation_000/goal_distance.csv", "evaluation_000/torques.csv", "evaluation_000/trial.bag",
             "trial_000/model.ddm", "trial_000/torques.csv", "trial_000/training.yaml", "trial_000/trial.bag",
             "trial_000/trial.1.bag.active"]))  # of the trial that was stopped
        config = read_yaml(self.out, "config.yaml")
        self.assertEqual((config["evaluation"]["goal_distance"], config["robot"]["crop"][0]), (0.3, 5))
        bag = os.path.join(self.out, "trial_000", "trial.bag")
        stamps = read_bag(bag)
        self.assertTrue(set(stamps["torque"]) <= set(stamps["camera/image_raw"]))
        self.assertIn(len(stamps["torque"]), range(STEPS // 2, STEPS + 1))  # all in time where nothing else runs
        self.assertEqual(len(stamps["goal_image"]), 1)
        self.assertLess(abs(1e-9 * stamps["torque"][0] - time.time()), 600.0)
        steps = sorted(1e-9 * (after - before) for before, after in zip(stamps["torque"], stamps["torque"][1:]))
        self.assertAlmostEqual(steps[len(steps) // 2], DT, delta=0.3 * DT)
        with rosbag.Bag(bag) as messages:
            image = next(message for _, message, _ in messages.read_messages(["camera/image_raw"]))
        self.assertEqual((image.width, image.height, image.encoding), (51, 51, "mono8"))
        self.assertEqual(len(read_rows(self.out, "evaluation_000", "goal_distance.csv")), 1 + STEPS)
        row = read_rows(self.out, "trials.csv")[1]
        self.assertIn(row[3], ["0", "1"])  # judged ...
        self.assertEqual(row[5], "")  # ... without ground truth
        check = read_yaml(self.out, "robot_check.yaml")
        self.assertEqual(check["frames"], 2 * STEPS)
        self.assertLess(check["latency_ms"]["median"], 1e3 * DT)
        self.assertLess(check["deadline_misses"], STEPS)  # none on a machine that has nothing else to do
        self.assertEqual([row["trial"] for row in check["evaluations"]], [0])

    def test_a_rehearsal_runs_to_its_end_with_a_listener_in_the_place_of_the_motor(self):
        """Runs the rehearsal of the tutorial, with the motors enabled, and replays the bag that it recorded."""
        listener = rospy.Subscriber("/rehearsal", Float64, lambda _: None)
        self.addCleanup(listener.unregister)
        config = self.write("my_robot.yaml", "robot: {max_torque: 2.0, dt: %g}\n" % DT)
        camera = rospy.Publisher("/usb_cam/image_raw", Image, queue_size=1)
        shown = rospy.Timer(rospy.Duration(0.04), lambda _: camera.publish(Image(
            header=Header(stamp=rospy.Time.now()), width=64, height=64, step=64, encoding="mono8", data=os.urandom(64 * 64))))
        self.addCleanup(shown.shutdown)
        launch = start_roslaunch(self.scratch, "robot.launch", "camera:=/usb_cam/image_raw", "effort:=/rehearsal", "preset:=debug",
                                 "trials:=0", "config:=" + config, "runs:=" + self.out, port=0)
        self.addCleanup(launch.stop)
        launch.waitForText("call service take_goal", LIMIT_S)
        self.assertTrue(rospy.ServiceProxy("take_goal", Trigger)().success)
        self.assertTrue(rospy.ServiceProxy("enable", SetBool)(True).success)
        launch.waitForText("reset_done", LIMIT_S)
        self.assertTrue(rospy.ServiceProxy("reset_done", Trigger)().success)
        launch.waitForText("motors follow", LIMIT_S)
        publishers, _, _ = rosgraph.Master("/robot_loop_test").getSystemState()
        self.assertEqual(dict(publishers)["/rehearsal"], ["/robot_node"])
        self.assertEqual([name for name, _ in publishers if name.endswith("effort_command")], [])
        deadline = time.monotonic() + LIMIT_S
        while not rospy.ServiceProxy("reset_done", Trigger)().success:  # for the evaluation, after the training
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.1)
        launch.waitForEnd(LIMIT_S)
        self.assertIn("summary.yaml", files_in(self.out), launch.output)
        trial = os.path.join(self.out, "trial_000")
        _, output = roslaunch(self.scratch, "replay.launch", "bag:=" + os.path.join(trial, "trial.bag"), "rate:=0",
                              "model:=" + os.path.join(trial, "model.ddm"), "preset:=debug", "config:=" + config, limit_s=LIMIT_S)
        self.assertIn("frames replayed", output)


if __name__ == "__main__":
    rospy.init_node("robot_loop_test")
    rosunit.unitrun("ddm_launch", "robot_loop", RobotLoopTest)
