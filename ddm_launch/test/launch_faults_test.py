#!/usr/bin/python3
# What is wrong in the arguments or files of a launch is named on the terminal, and leaves no folder.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import roslaunch  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402


class LaunchFaultsTest(ScratchCase):
    def assertRefused(self, words, *arguments):
        """The launch ends by itself, its output has the words, and it leaves no folder."""
        _, output = roslaunch(self.scratch, "experiment.launch", "trials:=0", "runs:=" + self.out, *arguments,
                              limit_s=40.0)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.out))

    def assertConfigRefused(self, text, words):
        path = self.write("differs.yaml", text)
        self.assertRefused(["REQUIRED process [", "exit code 1"] + words, "preset:=debug", "config:=" + path)

    def test_a_preset_that_does_not_exist_is_named(self):
        self.assertRefused(["file does not exist", "config/presets/papier.yaml"], "preset:=papier")

    def test_a_plant_that_does_not_exist_is_named(self):
        self.assertRefused(["file does not exist", "ddm_sim/config/windmill.yaml"], "plant:=windmill")

    def test_a_nuisance_that_does_not_exist_is_named(self):
        self.assertRefused(["file does not exist", "config/nuisances/fog.yaml"], "nuisance:=fog")

    def test_a_file_of_that_name_that_is_no_plant_is_refused(self):
        self.assertRefused(["unknown plant 'sim'", "pendulum_gravity"], "preset:=debug", "plant:=sim")

    def test_a_missing_folder_argument_is_named(self):
        code, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", limit_s=40.0)
        self.assertEqual(code, 1)
        self.assertIn("arg 'runs' is not defined", output)

    def test_a_negative_seed_is_refused(self):
        self.assertRefused(["experiment/seed must be >= 0, got -1"], "preset:=debug", "seed:=-1")

    def test_a_misspelt_key_of_the_simulator_is_named(self):
        self.assertConfigRefused("sim: {wacthdog: 1.0}\n", ["sim/wacthdog", "did you mean watchdog?"])

    def test_a_misspelt_key_of_the_controller_is_named(self):
        self.assertConfigRefused("controller: {timeot: 1.0}\n", ["controller/timeot", "timeout"])

    def test_a_misspelt_key_of_the_recorder_is_named(self):
        self.assertConfigRefused("recorder: {timeot: 1.0}\n", ["recorder/timeot", "timeout"])


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "launch_faults_test", LaunchFaultsTest)
