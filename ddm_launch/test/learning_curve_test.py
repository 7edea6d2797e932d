# The learning curve: its numbers, its pictures, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import math
import os
import re

from PIL import Image

from figure_case import call_figure
from ddm_launch import figure_style, learning_curve
from ddm_launch.run_folder import read_goal, read_trials
from run_files import changes, fingerprint
from scratch_case import ScratchCase
import synthetic_run


class LearningCurveTest(ScratchCase):
    def makeRun(self, name, successes, errors_deg=None):
        folder = self.file(name)
        synthetic_run.write_trials(folder, successes, errors_deg or ["12.5"] * len(successes))
        synthetic_run.write_config(folder)
        return folder

    def callMain(self, *arguments):
        """Returns (exit code, output)."""
        return call_figure(learning_curve, *arguments)

    def test_success_rate_has_the_standard_error_of_the_paper(self):
        runs = [read_trials(self.makeRun("run_%d" % k, s)) for k, s in enumerate([["0", "1"], ["0", "1"], ["1", "1"]])]
        rows = learning_curve.success_rates(runs)
        self.assertEqual([row[0] for row in rows], [100, 200])
        self.assertAlmostEqual(rows[0][1], 1.0 / 3.0)
        self.assertAlmostEqual(rows[0][2], math.sqrt((1.0 / 3.0) * (2.0 / 3.0) / 2.0))
        self.assertEqual(rows[1][1:], (1.0, 0.0, 3))

    def test_trials_of_unknown_success_are_left_out_of_the_rate(self):
        runs = [read_trials(self.makeRun("a", ["", "1"])), read_trials(self.makeRun("b", ["0", "0"]))]
        self.assertEqual(learning_curve.success_rates(runs)[0], (100, 0.0, 0.0, 1))

    def test_runs_of_different_length_count_where_they_have_rows(self):
        runs = [read_trials(self.makeRun("a", ["1", "1"])), read_trials(self.makeRun("b", ["0"]))]
        self.assertEqual([(row[0], row[3]) for row in learning_curve.success_rates(runs)], [(100, 2), (200, 1)])

    def test_the_picture_is_drawn_where_one_is_by_default_and_not_into_the_run(self):
        folder = self.makeRun("run", ["0", "1", ""], ["-170", "3", ""])
        before = fingerprint(folder)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.scratch)
        self.assertEqual(self.callMain(folder)[0], 0)
        self.assertEqual(changes(before, fingerprint(folder)), [])
        with Image.open(self.file("learning_curve.png")) as picture:
            self.assertGreater(len(set(picture.convert("L").tobytes())), 10)  # not blank

    def test_several_runs_are_drawn_into_the_file_that_is_named_and_nowhere_else(self):
        folders = [self.makeRun(name, ["0", "1"]) for name in "ab"]
        out = self.file("curve.png")
        self.assertEqual(self.callMain(*folders, "--out", out)[0], 0)
        self.assertTrue(os.path.getsize(out) > 0)
        self.assertEqual([sorted(os.listdir(folder)) for folder in folders], [["config.yaml", "trials.csv"]] * 2)

    def test_a_run_that_does_not_tell_its_goal_is_refused(self):
        folder = self.makeRun("run", ["1"], ["0.04"])
        config = os.path.join(folder, "config.yaml")
        for text in ("evaluation: [\n", "plant: {dt: 0.1}\n", "evaluation: {tolerance: 0.05}\n", "7\n", None):
            self.write(config, text or "")
            if text is None:
                os.remove(config)
            code, output = self.callMain(folder)
            self.assertEqual(code, 1, output)
            self.assertIn(config, output)

    def test_errors_are_in_the_unit_of_the_run(self):
        folder = self.makeRun("run", ["1"], ["0.04"])
        self.write(os.path.join("run", "config.yaml"), "evaluation: {tolerance: 0.05, error_unit: m}\n")
        self.assertEqual(read_goal(folder), ("m", 0.05))
        with figure_style.new_screen_figure(7.0, 4.2) as figure:
            axes = figure.subplots()
            learning_curve.draw_one(axes, read_trials(folder), read_goal(folder))
            self.assertIn("[m]", axes.get_ylabel())

    def test_a_folder_that_is_no_run_folder_is_named(self):
        code, errors = self.callMain(self.scratch)
        self.assertEqual(code, 1)
        self.assertIn(self.file("trials.csv"), errors)

    def test_a_cell_that_is_no_number_is_named(self):
        code, errors = self.callMain(self.makeRun("run", ["maybe"]))
        self.assertEqual(code, 1)
        self.assertIn("maybe", errors)

    def test_a_missing_column_is_named(self):
        folder = self.makeRun("run", ["1"])
        with open(os.path.join(folder, "trials.csv"), "w") as stream:
            stream.write("trial,success\n0,1\n")
        code, errors = self.callMain(folder)
        self.assertEqual(code, 1)
        self.assertIn("frames, final_error", errors)

    def test_a_run_without_any_final_error_is_refused(self):
        code, errors = self.callMain(self.makeRun("run", [""], [""]))
        self.assertEqual(code, 1)
        self.assertIn("trials.csv", errors)

    def test_a_picture_that_cannot_be_completed_is_named_and_nothing_of_it_is_left(self):
        folder, out = self.makeRun("run", ["1"]), self.file("curve.png")
        self.limitFiles(1000)
        code, errors = self.callMain(folder, "--out", out)
        self.assertEqual(code, 1)
        self.assertRegex(errors, "^learning_curve: .*%s: %s\n$" % (re.escape(out), os.strerror(errno.EFBIG)))
        self.assertEqual(os.listdir(self.scratch), ["run"])

    def test_a_picture_format_that_does_not_exist_is_refused(self):
        code, errors = self.callMain(self.makeRun("run", ["1"]), "--out", self.file("curve.nonsense"))
        self.assertEqual(code, 1)
        self.assertIn("nonsense", errors)
