# run_experiment with PILCO: what it refuses, and a saved configuration.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import run_experiment
from run_files import differences
from scratch_case import ScratchCase


class PilcoTest(ScratchCase):
    def debug(self, trials, out=None):
        return ["--preset", "debug", "--seed", 1, "--trials", trials, "--out", out or self.out]

    def assertRuns(self, *arguments):
        code, output = run_experiment(*arguments)
        self.assertEqual(code, 0, output)

    def assertRefused(self, code, words, *arguments):
        actual, output = run_experiment(*arguments)
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)

    def test_help_names_the_baselines(self):
        code, output = run_experiment("--help")
        self.assertEqual(code, 0)
        for method in ("pilco_state", "pilco_features", "pilco_pca"):
            self.assertIn(method + ": PILCO on ", output)

    def test_a_method_that_does_not_fit_the_plant_is_refused(self):
        self.assertRefused(1, ["method pilco_features"], "--method", "pilco_state", "--plant", "moving_tile",
                           "--out", self.out)
        joint = self.write("joint.yaml", "training: {schedule: joint}\n")
        self.assertRefused(1, ["training/schedule", "v_r_only", "got joint"], "--method", "pilco_features",
                           "--config", joint, *self.debug(trials=0))
        self.assertFalse(os.path.exists(self.out))

    def test_a_saved_configuration_of_a_baseline_can_be_given_again(self):
        self.assertRuns("--method", "pilco_state", *self.debug(trials=0))
        again = self.file("again")
        self.assertRuns("--config", os.path.join(self.out, "config.yaml"), "--seed", 1, "--trials", 0, "--out", again)
        names = ["trial_000/prediction.csv", "evaluation_000/torques.csv"]
        self.assertEqual(differences(self.out, again, names), [])
