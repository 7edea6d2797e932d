# config.yaml of an experiment, given back, is the same experiment again, in both drivers.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import roslaunch, run_experiment
from run_files import differences, expected_files, read_yaml
from scratch_case import SharedScratchCase

TRIALS = 1
PLANT = "pendulum_gravity"


class GivenBackTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        """An experiment in which nothing is as by default, and which starts from a model and a bag."""
        super().setUpClass()
        before, cls.original = (os.path.join(cls.class_scratch, name) for name in ("before", "original"))
        config = os.path.join(cls.class_scratch, "more.yaml")
        with open(config, "w") as stream:
            stream.write("mpc: {horizon: 4}\nplant: {friction: 0.02}\n")
        for words in ((["--seed", 1, "--trials", 0, "--out", before]),
                      (["--seed", 5, "--trials", TRIALS, "--out", cls.original, "--nuisance", "noise", "--config",
                        config, "--model", os.path.join(before, "trial_000", "model.ddm"), "--bags",
                        os.path.join(before, "trial_000", "trial.bag")])):
            code, output = run_experiment("--preset", "debug", "--plant", PLANT, *words)
            assert code == 0, output
        cls.config = os.path.join(cls.original, "config.yaml")

    def assertReproduced(self, output):
        """All files but the bags, whose stamps are another simulated time."""
        self.assertTrue(os.path.exists(os.path.join(self.out, "summary.yaml")), output)
        names = [name for name in expected_files(TRIALS) if not name.endswith(".bag")]
        self.assertEqual(differences(self.original, self.out, names), [])
        self.assertEqual(read_yaml(self.out, "config.yaml")["experiment"]["runs"], self.out)

    def test_run_experiment_reproduces_it(self):
        code, output = run_experiment("--repeat", self.original, "--out", self.out)
        self.assertEqual(code, 0, output)
        self.assertReproduced(output)

    def test_the_nodes_reproduce_it(self):
        _, output = roslaunch(self.scratch, "experiment.launch", "config:=original/config.yaml", "runs:=" + self.out,
                              folder=self.class_scratch)
        self.assertReproduced(output)

    def test_a_saved_plant_is_not_mixed_with_another(self):
        code, output = run_experiment("--config", self.config, "--plant", "pendulum", "--out", self.out)
        self.assertEqual(code, 2, output)
        self.assertIn(self.config, output)
        self.assertIn(PLANT, output)
        self.assertFalse(os.path.exists(self.out))
