# What is kept of PILCO's run folders, and that all readers accept its trials.csv with empty columns.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch import learning_curve, success_rate
from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep, read_trials
from ddm_study import pilco_runs
import figure_case
import synthetic_run


class PilcoRunsTest(figure_case.FigureCase):
    def setUp(self):
        super().setUp()
        self.run_folder = self.file("seed_0007")
        synthetic_run.write_pilco_run(self.run_folder, seed=7)

    def path(self, *names):
        return os.path.join(self.run_folder, *names)

    def test_columns_without_meaning_may_be_empty(self):
        with open(self.path("trials.csv")) as stream:
            self.assertIn(",,,10,", stream.read())  # v_r, v_p
        self.assertEqual([(trial.frames, trial.success) for trial in read_trials(self.run_folder)],
                         [(125, True), (250, True), (375, True)])
        self.assertEqual(list(read_sweep(self.path("trials.csv"))), [7])
        self.assertEqual(success_rate.read_curve("PILCO, state", self.path("trials.csv")).frames, [125, 250, 375])
        code, output = self.callMain(learning_curve, self.run_folder)
        self.assertEqual((code, output), (0, "wrote %s\n" % self.out))

    def test_each_search_has_a_row(self):
        rows = pilco_runs.search_rows({7: self.run_folder})
        self.assertEqual([row[:5] for row in rows], [[7, 0, 125, 1.0, 9.0], [7, 1, 250, 2.0, 9.0],
                                                     [7, 2, 375, 3.0, 9.0]])
        self.assertEqual(dict(zip(pilco_runs.SEARCH_KEYS, rows[1][3:])),
                         {"gp_s": 2, "policy_search_s": 9, "sparse": False, "points": 250, "iterations": 75,
                          "evaluations": 190, "cost_before": 80.5, "cost_after": 3.25,
                          "message": "line searches used up"})

    def test_a_run_that_is_not_pilcos_is_named(self):
        path = self.write(self.path("trial_001", "pilco.yaml"), "gp_s: 1\npolicy_search_s: 2\n")
        with self.assertRaisesRegex(Failure, "trial_001/pilco.yaml.*sparse, points"):
            pilco_runs.search_rows({7: self.run_folder})
        os.remove(path)
        with self.assertRaisesRegex(Failure, "trial_001/pilco.yaml"):
            pilco_runs.search_rows({7: self.run_folder})

    def test_a_policy_is_shown_as_predicted_in_its_evaluation_and_in_the_next_trial(self):
        rows = pilco_runs.distribution_rows({7: self.run_folder}, [1])
        at_step_1 = [row for row in rows if row[4] == 1]
        self.assertEqual(at_step_1, [(7, 1, 250, "predicted", 1, "0.200", "1.1000", "0.2500"),
                                     (7, 1, 250, "evaluation", 1, "0.200", "2.1000", ""),
                                     (7, 1, 250, "trial", 1, "0.200", "3.1000", "")])
        self.assertEqual([row[5] for row in rows if row[4] == 0], ["0.000"] * 3)  # from the first frame on
        self.assertEqual(len(rows), 9)
        self.assertEqual(len(pilco_runs.DISTRIBUTION_COLUMNS), len(rows[0]))

    def test_the_last_policy_has_no_further_trial_and_trials_that_were_not_run_are_left_out(self):
        rows = pilco_runs.distribution_rows({7: self.run_folder, 8: self.run_folder}, [2, 3])
        self.assertEqual([(row[0], row[1], row[3]) for row in rows if row[4] == 0],
                         [(seed, 2, kind) for seed in (7, 8) for kind in ("predicted", "evaluation")])

    def test_a_prediction_of_something_else_than_the_angle_is_refused(self):
        with open(self.path("trial_000", "prediction.csv"), "w") as stream:
            stream.write("step,time_s,z_1_mean,z_1_std,cost_mean,cost_std\n0,0,0.1,0.1,,\n")
        with self.assertRaisesRegex(Failure, "trial_000/prediction.csv.*angle_rad_mean"):
            pilco_runs.distribution_rows({7: self.run_folder}, [0])
