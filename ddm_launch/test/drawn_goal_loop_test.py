# Plant `suite_reacher_hard`, which draws a goal with each start; the nodes and run_experiment give the same.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os

import rosbag

from both_drivers_case import BothDriversCase
from processes import needs_mujoco
from run_files import read_rows, read_yaml

TRIALS = 1
QUICK = """training: {num_starts: 1, max_iterations: 20}
trial: {num_steps: 30, episodes: 1}
evaluation: {num_steps: 40, record: true}
"""
RUNS = ["%s_%03d" % (kind, k) for k in range(TRIALS + 1) for kind in ("trial", "evaluation")]


def goal_pictures(folder, run):
    """The pictures on goal_image in the bag of a run."""
    with rosbag.Bag(os.path.join(folder, run, "trial.bag")) as bag:
        return [message.data for _, message, _ in bag.read_messages(topics=["goal_image"])]


@needs_mujoco
class DrawnGoalLoopTest(BothDriversCase):
    """Policy, bags and evaluation go by the goal of their run."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "debug", "plant": "suite_reacher_hard"}, QUICK)

    def test_both_finish_with_equal_files(self):
        self.assertAllFilesAreEqual()

    def test_each_bag_holds_the_goal_of_its_run_the_same_in_both_drivers(self):
        goals = {run: goal_pictures(self.nodes, run) for run in RUNS}
        self.assertEqual({run: len(pictures) for run, pictures in goals.items()}, {run: 1 for run in RUNS})
        self.assertEqual(len({pictures[0] for pictures in goals.values()}), len(RUNS))
        self.assertEqual(goals, {run: goal_pictures(self.process, run) for run in RUNS})

    def test_greedy_runs_last_as_long_as_the_evaluation_says_and_have_a_return(self):
        for k in range(TRIALS + 1):
            self.assertEqual(len(read_rows(self.nodes, "trial_%03d" % k, "torques.csv")), 1 + 30)
            self.assertEqual(len(read_rows(self.nodes, "evaluation_%03d" % k, "torques.csv")), 1 + 40)
        rows = read_rows(self.nodes, "trials.csv")
        column = rows[0].index("return")
        self.assertTrue(all(0.0 <= float(row[column]) <= 40 * 5 for row in rows[1:]), rows)

    def test_errors_are_in_metres_from_the_finger_to_its_place_at_the_goal(self):
        self.assertEqual(read_yaml(self.nodes, "config.yaml")["evaluation"]["error_unit"], "m")
        rows = read_rows(self.nodes, "trials.csv")
        column = rows[0].index("final_error")
        errors = [float(row[column]) for row in rows[1:]]
        self.assertTrue(all(0.0 < error <= 0.44 for error in errors), errors)  # across the reach of the arm
        for k, error in enumerate(errors):
            last = read_rows(self.nodes, "evaluation_%03d" % k, "trajectory.csv")[-1]
            shoulder, wrist = float(last[2]), float(last[3])
            finger = [0.12 * (f(shoulder) + f(shoulder + wrist)) for f in (math.cos, math.sin)]
            # targets lie between 0.05 and 0.20 m from the middle
            self.assertLessEqual(error, math.hypot(*finger) + 0.2)
            self.assertGreaterEqual(error, max(0.0, math.hypot(*finger) - 0.2))
