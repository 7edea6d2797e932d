# task_diagnosis: what it says of a small run, and of what it cannot say anything.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import math
import os

import numpy as np

from ddm_study import task_diagnosis
from processes import call_main, run_experiment
from scratch_case import ScratchCase


class TaskDiagnosisTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.run_folder, self.table = self.file("run"), self.file("diagnosis.csv")

    def makeRun(self, trials, plant="two_link"):
        code, output = run_experiment("--preset", "debug", "--plant", plant, "--seed", 3, "--trials", trials, "--out",
                                      self.run_folder)
        self.assertEqual(code, 0, output)

    def call(self):
        return call_main(task_diagnosis.main, [self.run_folder, "--out", self.table])

    def test_a_run_has_rows_for_features_predictions_and_goal(self):
        self.makeRun(1)
        code, output = self.call()
        self.assertEqual(code, 0, output)
        with open(self.table, newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([(row["part"], row["steps"], row["joint"]) for row in rows], [
            ("features", "0", "shoulder"), ("features", "0", "elbow"),
            *(("prediction", steps, joint) for steps in ("1", "5", "15") for joint in ("shoulder", "elbow")),
            ("goal", "", "all")])
        for row in rows[:-1]:
            self.assertEqual((row["task"], row["seed"], row["frames"], row["unit"]), ("two_link", "3", "30", "deg"))
            self.assertLessEqual(0.0, float(row["median"]))
            self.assertLessEqual(float(row["median"]), float(row["quantile_90"]))
            self.assertLessEqual(float(row["quantile_90"]), 180.0)
        self.assertLess(float(rows[0]["median"]), 45.0)  # it would be 90 of features that say nothing
        self.assertTrue(0.0 <= float(rows[-1]["share"]) < 0.5)

    def test_a_run_of_one_trial_is_refused(self):
        self.makeRun(0)
        code, output = self.call()
        self.assertEqual(code, 1)
        self.assertIn("%s must have two trials at least, got 1" % self.run_folder, output)
        self.assertFalse(os.path.exists(self.table))

    def test_a_damaged_bag_is_named(self):
        self.makeRun(1)
        bag = os.path.join(self.run_folder, "trial_001", "trial.bag")
        os.truncate(bag, os.path.getsize(bag) // 2)
        code, output = self.call()
        self.assertEqual(code, 1, output)
        self.assertIn(bag, output)
        self.assertNotIn("Traceback", output)

    def test_a_plant_in_pixels_is_refused(self):
        self.makeRun(1, "moving_tile")
        code, output = self.call()
        self.assertEqual(code, 1)
        self.assertIn("plant moving_tile: positions must be in rad or m, got px", output)

    def test_angles_are_compared_around_the_circle_and_lengths_are_not(self):
        joints = task_diagnosis.Joints("two_link")
        np.testing.assert_allclose(joints.goal, [math.pi, 0.0])
        np.testing.assert_allclose(joints.distances(np.array([[3.0, 0.1]]), np.array([-3.0, 4 * math.pi])),
                                   [[2.0 * math.pi - 6.0, 0.1]])
        joints.units = ("m", "m")
        np.testing.assert_allclose(joints.distances(np.array([3.0, 0.1]), np.array([-3.0, 0.0])), [6.0, 0.1])

    def test_the_goal_was_seen_where_all_joints_were_near_it_at_once(self):
        joints = task_diagnosis.Joints("two_link")
        near, far = math.radians(19.0), math.radians(21.0)
        self.assertEqual(joints.share_near_goal(np.array([[math.pi - near, near], [-math.pi + near, -near],
                                                          [math.pi - far, 0.0], [math.pi, far]])), 0.5)
