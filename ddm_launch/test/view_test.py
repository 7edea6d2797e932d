#!/usr/bin/python3
# What can be watched of an experiment without rviz, and that watching changes nothing.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import math
import os
import sys
import time

from ddm_msgs.msg import PlanScalars
import numpy as np
import rospy
import rosunit
from sensor_msgs.msg import Image
from std_msgs.msg import String
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import Process, find_program, roslaunch, run_experiment  # noqa: E402
from run_files import differences, expected_files  # noqa: E402
from scratch_case import SharedScratchCase  # noqa: E402

TRIALS = 1
FRAMES = 2 * 30 * (TRIALS + 1)
RATE = 30.0  # so low that the rest of the launch takes less time than these frames
TOPICS = {"trials": String, "prediction_image": Image, "feature_space_image": Image,
          "plan_scalars": PlanScalars}


def pixels(image):
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, -1)


class ViewTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = os.path.join(cls.class_scratch, "run")
        cls.heard = collections.defaultdict(list)
        rospy.init_node("view_test", disable_signals=True)
        for topic, message in TOPICS.items():
            rospy.Subscriber(topic, message, cls.heard[topic].append)
        start = time.monotonic()
        _, cls.output = roslaunch(cls.class_scratch, "experiment.launch", "preset:=debug", "seed:=1",
                                  "trials:=%d" % TRIALS, "view:=true", "frame_rate:=%g" % RATE,
                                  "runs:=" + cls.run_folder, port=0, limit_s=110.0)
        cls.wall_s = time.monotonic() - start

    def test_an_experiment_that_is_watched_and_slowed_down_is_the_same(self):
        unwatched = self.file("unwatched")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", TRIALS, "--out", unwatched)
        self.assertEqual(code, 0, output)
        names = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]
        self.assertEqual(differences(unwatched, self.run_folder, names), [], self.output)
        self.assertGreater(self.wall_s, FRAMES / RATE)

    def test_the_table_of_trials_grows_and_is_drawn(self):
        tables = [yaml.safe_load(message.data) for message in self.heard["trials"]]
        self.assertEqual([table["trials_csv"].count("\n") for table in tables], list(range(1, TRIALS + 3)))
        self.assertEqual({table["frames"] for table in tables}, {30 * (TRIALS + 1)})
        rospy.Publisher("trials", String, queue_size=1, latch=True).publish(self.heard["trials"][-1])
        node = Process([find_program("figure"), "learning_curve_node"])
        self.addCleanup(node.stop)
        image = rospy.wait_for_message("learning_curve_image", Image, 60.0)
        self.assertEqual((image.width, image.height, image.encoding), (640, 480, "rgb8"), node.output)
        self.assertGreater(np.mean(pixels(image) < 200), 0.01)

    def test_prediction_and_feature_space_are_topics(self):
        prediction, plane = self.heard["prediction_image"], self.heard["feature_space_image"]
        self.assertTrue(prediction and plane)
        self.assertEqual((prediction[-1].width, prediction[-1].encoding), (3 * 255 + 6, "mono8"))
        self.assertEqual((plane[-1].width, plane[-1].height, plane[-1].encoding), (605, 605, "rgb8"))

    def test_numbers_of_each_plan_can_be_plotted(self):
        scalars = self.heard["plan_scalars"]
        self.assertGreater(len(scalars), 30 * (TRIALS + 1))  # all of the evaluations, and some
        self.assertTrue(all(number.goal_distance >= 0.0 and number.solve_time > 0.0 for number in scalars))
        self.assertTrue(any(math.isnan(number.prediction_error) for number in scalars))
        self.assertTrue(any(number.prediction_error > 0.0 for number in scalars))


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "view_test", ViewTest)
