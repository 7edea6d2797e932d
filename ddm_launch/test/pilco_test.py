# run_experiment with PILCO: its files, that an interruption changes nothing, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal

from processes import Process, find_program, run_experiment
from run_files import differences, files_in, read_rows
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

    def test_a_baseline_that_was_killed_goes_on_as_if_nothing_had_happened(self):
        trials, names = 4, []  # GPs grow: each training takes longer than the one before
        for k in range(trials + 1):
            names += ["trial_%03d/%s" % (k, name) for name in ("prediction.csv", "torques.csv", "trajectory.csv")]
            names += ["evaluation_%03d/%s" % (k, name) for name in ("torques.csv", "trajectory.csv")]
        arguments = ["--method", "pilco_state"] + self.debug(trials)
        process = Process([find_program("run_experiment")] + arguments)
        process.waitForText("trial %2d/%d" % (2, trials), 60.0)
        process.send(signal.SIGKILL)
        process.waitForEnd(10.0)
        self.assertNotIn("summary.yaml", files_in(self.out))
        self.assertRuns(*arguments)
        uninterrupted = self.file("uninterrupted")
        self.assertRuns("--method", "pilco_state", *self.debug(trials, out=uninterrupted))
        self.assertEqual(differences(uninterrupted, self.out, names), [])
        rows = read_rows(self.out, "trials.csv")
        self.assertEqual([row[2] for row in rows[1:]], [str(125 * (k + 1)) for k in range(trials + 1)])
        self.assertEqual({tuple(row[6:8]) for row in rows[1:]}, {("", "")})

    def test_a_saved_configuration_of_a_baseline_can_be_given_again(self):
        self.assertRuns("--method", "pilco_state", *self.debug(trials=0))
        again = self.file("again")
        self.assertRuns("--config", os.path.join(self.out, "config.yaml"), "--seed", 1, "--trials", 0, "--out", again)
        names = ["trial_000/prediction.csv", "evaluation_000/torques.csv"]
        self.assertEqual(differences(self.out, again, names), [])
