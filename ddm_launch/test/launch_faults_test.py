# What is wrong in the arguments or files of a launch is named on the terminal, and leaves no folder.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import roslaunch
from scratch_case import ScratchCase


class LaunchFaultsTest(ScratchCase):
    def assertRefused(self, words, *arguments):
        """The launch ends by itself, its output has the words, and it leaves no folder."""
        _, output = roslaunch(self.scratch, "experiment.launch", "trials:=0", "runs:=" + self.out, *arguments,
                              limit_s=40.0)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.out))
        return output

    def assertRefusedBeforeAnyNode(self, words, *arguments):
        output = self.assertRefused(words, *arguments)
        self.assertNotIn("process[", output)

    def assertConfigRefused(self, text, words):
        path = self.write("differs.yaml", text)
        self.assertRefused(words, "preset:=debug", "config:=" + path)

    def test_a_preset_that_does_not_exist_is_named(self):
        self.assertRefusedBeforeAnyNode(["unknown preset 'papier'", "debug, efficient"], "preset:=papier")

    def test_a_plant_that_does_not_exist_is_named(self):
        self.assertRefusedBeforeAnyNode(["unknown plant 'windmill'", "pendulum_gravity"], "plant:=windmill")

    def test_a_nuisance_that_does_not_exist_is_named(self):
        self.assertRefusedBeforeAnyNode(["unknown configuration 'nuisance/fog'", "clutter"], "nuisance:=fog")

    def test_a_file_that_does_not_exist_is_named(self):
        self.assertRefusedBeforeAnyNode(["no/such.yaml"], "config:=no/such.yaml")

    def test_a_method_without_nodes_is_refused(self):
        self.assertConfigRefused("experiment: {method: oracle}\n", ["experiment/method", "oracle"])

    def test_a_file_of_that_name_that_is_no_plant_is_refused(self):
        self.assertRefusedBeforeAnyNode(["unknown plant 'sim'", "pendulum_gravity"], "plant:=sim")

    def test_a_missing_folder_argument_is_named(self):
        code, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", limit_s=40.0)
        self.assertEqual(code, 1)
        self.assertIn("'runs'", output)

    def test_a_negative_seed_is_refused(self):
        self.assertRefusedBeforeAnyNode(["experiment/seed", "-1"], "preset:=debug", "seed:=-1")
        self.assertRefusedBeforeAnyNode(["experiment/seed", "one"], "preset:=debug", "seed:=one")

    def test_a_misspelt_key_of_the_simulator_is_named(self):
        self.assertConfigRefused("sim: {wacthdog: 1.0}\n", ["sim/wacthdog", "watchdog?"])

    def test_what_contradicts_is_refused(self):
        path = self.write("differs.yaml", "mpc: {max_torque: 6.5}\n")
        self.assertRefusedBeforeAnyNode(["mpc/max_torque", "plant/max_torque"], "preset:=debug", "config:=" + path)

    def test_a_misspelt_key_of_the_controller_is_named(self):
        self.assertConfigRefused("controller: {timeot: 1.0}\n", ["controller/timeot", "timeout"])

    def test_a_misspelt_key_of_the_recorder_is_named(self):
        self.assertConfigRefused("recorder: {timeot: 1.0}\n", ["recorder/timeot", "timeout"])
