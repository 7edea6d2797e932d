# A run folder in pandas: the README's lines, every step of every episode, and folders that are none.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re

import numpy as np

import ddm_model
from processes import run_experiment
from rooms import PACKAGE
from run_files import read_rows
from scratch_case import SharedScratchCase

EPISODES, TRIALS, STEPS = 2, 1, 30


class ReadRunTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        config = os.path.join(cls.class_scratch, "config.yaml")
        with open(config, "w") as stream:
            stream.write("trial: {episodes: %d}\n" % EPISODES)
        cls.folder = os.path.join(cls.class_scratch, "run")
        code, output = run_experiment("--preset", "debug", "--config", config, "--trials", str(TRIALS), "--out", cls.folder)
        if code != 0:
            raise AssertionError(output)
        cls.read = ddm_model.read_run(cls.folder)

    def test_one_row_for_each_model(self):
        self.assertEqual(self.read.trials.index.tolist(), [0, 1])
        self.assertEqual(self.read.trials.frames.tolist(), [EPISODES * STEPS, 2 * EPISODES * STEPS])
        self.assertEqual(self.read.config["trial"]["episodes"], EPISODES)

    def test_one_row_for_each_step_with_torque_and_state_as_in_the_tables(self):
        steps = self.read.steps
        self.assertTrue(steps.index.is_unique)
        counts = steps.groupby(level=["kind", "trial", "episode"]).size()
        self.assertEqual(counts.loc["trial"].to_dict(), {(k, e): STEPS for k in (0, 1) for e in (0, 1)})
        self.assertEqual(sorted(counts.loc["evaluation"].index), [(0, 0), (1, 0)])
        part = steps.loc[("trial", 1, 1)]
        for name, column in (("torques.csv", "torque_nm"), ("trajectory.csv", "angle_rad")):
            rows = read_rows(self.folder, "trial_001", "episode_001", name)
            truth = [float(row[rows[0].index(column)]) for row in rows[1:]]
            np.testing.assert_array_equal(part[column][:len(truth)], truth)

    def test_the_lines_of_the_readme(self):
        with open(os.path.join(PACKAGE, "..", "ddm_model", "README.md")) as stream:
            block = next(text for text in re.findall(r"```python\n(.*?)```", stream.read(), re.DOTALL) if "read_run" in text)
        names = {"ddm_model": ddm_model}
        exec(block.replace('"runs/one"', repr(self.folder)), names)  # pylint: disable=exec-used
        last = [float(read_rows(self.folder, "evaluation_%03d" % k, "trajectory.csv")[-1][2]) for k in (0, 1)]
        np.testing.assert_array_equal(names["errors"], last)

    def test_a_folder_that_is_none_is_refused_by_name(self):
        with self.assertRaisesRegex(ddm_model.RunFolderError, "cannot read .*trials.csv: No such file"):
            ddm_model.read_run(os.path.join(self.class_scratch, "elsewhere"))

    def test_a_damaged_table_is_refused_by_name(self):
        for content, words in (("", "No columns"), ("a,b\n1,2\n", "has no column 'trial', 'frames', only a, b"),
                               ("trial,frames\n1,2\n3,4,5,6\n", "cannot read")):
            folder = os.path.join(self.class_scratch, "damaged")
            os.makedirs(folder, exist_ok=True)
            with open(os.path.join(folder, "trials.csv"), "w") as stream:
                stream.write(content)
            with self.assertRaisesRegex(ddm_model.RunFolderError, words):
                ddm_model.read_run(folder)

    def test_a_configuration_that_is_none_is_refused(self):
        folder = os.path.join(self.class_scratch, "other")
        os.makedirs(folder, exist_ok=True)
        for name, content in (("trials.csv", "trial,frames\n0,100\n"), ("config.yaml", "just words\n")):
            with open(os.path.join(folder, name), "w") as stream:
                stream.write(content)
        with self.assertRaisesRegex(ddm_model.RunFolderError, "config.yaml must hold the blocks .* 'just words'"):
            ddm_model.read_run(folder)
