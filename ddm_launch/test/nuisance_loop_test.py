# All nuisances and all that is not the paper's at once: nodes and run_experiment still agree, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
import os

from both_drivers_case import BothDriversCase
from run_files import read_bag, read_rows, read_yaml

TRIALS = 1
STEP_NS = 200000000
REST = """camera: {noise_std: 0.1, brightness_drift: 0.2, delay: 1, drop_rate: 0.15}
plant: {rod_half_width: 0.05}
model: {residual: true, increments: true, order: 3}
training: {num_starts: 2, selection_steps: 2, prediction_steps: 2, weight_decay: 0.1}
mpc: {offset_gain: 0.3}
"""


class NuisanceLoopTest(BothDriversCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "debug", "nuisance": "clutter"}, REST)

    def test_both_finish_with_equal_files(self):
        self.assertAllFilesAreEqual()

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
