#!/usr/bin/python3
# All nuisances of the camera at once: the nodes and run_experiment still give the same, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import roslaunch, run_experiment  # noqa: E402
from run_files import differences, expected_files, read_bag, read_rows, read_yaml  # noqa: E402

TRIALS = 1
STEP_NS = 200000000
REST = "camera: {noise_std: 0.1, brightness_drift: 0.2, delay: 1, drop_rate: 0.15, rod_half_width: 0.05}\n"


class NuisanceLoopTest(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.mkdtemp()
        config = os.path.join(cls.scratch, "rest.yaml")
        with open(config, "w") as stream:
            stream.write(REST)
        cls.nodes, cls.process = os.path.join(cls.scratch, "nodes"), os.path.join(cls.scratch, "process")
        _, cls.nodes_output = roslaunch(cls.scratch, "experiment.launch", "preset:=debug", "nuisance:=clutter",
                                        "seed:=4", "trials:=%d" % TRIALS, "config:=" + config, "runs:=" + cls.nodes)
        _, cls.process_output = run_experiment("--preset", "debug", "--nuisance", "clutter", "--seed", 4, "--trials",
                                               TRIALS, "--config", config, "--out", cls.process)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.scratch)

    def test_both_finish_with_equal_files(self):
        self.assertTrue(os.path.exists(os.path.join(self.nodes, "summary.yaml")), self.nodes_output)
        self.assertTrue(os.path.exists(os.path.join(self.process, "summary.yaml")), self.process_output)
        names = [name for name in expected_files(TRIALS) if not name.endswith((".lock", ".bag"))]
        self.assertGreater(len(names), 8)
        self.assertEqual(differences(self.nodes, self.process, names), [])

    def test_the_nuisance_of_the_argument_and_those_of_the_file_are_on(self):
        camera = read_yaml(self.nodes, "config.yaml")["camera"]
        self.assertEqual((camera["clutter"], camera["noise_std"], camera["delay"]), (0.6, 0.1, 1))

    def test_bags_have_gaps_of_whole_steps_in_both(self):
        for k in range(TRIALS + 1):
            gaps = []
            for folder in (self.nodes, self.process):
                stamps = read_bag(os.path.join(folder, "trial_%03d" % k, "trial.bag"))
                self.assertEqual(len(stamps["camera/image_raw"]), 30)
                self.assertEqual(stamps["camera/image_raw"], stamps["torque"])
                images = stamps["camera/image_raw"]
                gaps.append([after - before for before, after in zip(images, images[1:])])
            self.assertEqual(gaps[0], gaps[1])
            self.assertEqual([gap % STEP_NS for gap in gaps[0]], [0] * 29)
            self.assertGreater(max(gaps[0]), STEP_NS)

    def test_a_trial_counts_the_frames_that_are_seen(self):
        self.assertEqual([row[2] for row in read_rows(self.nodes, "trials.csv")[1:]], ["30", "60"])


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "nuisance_loop", NuisanceLoopTest)
