# Experiments that start from a model and bags, and evaluate: the same by both drivers, resumed, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

from processes import call, find_program, roslaunch, run_experiment
from run_files import differences, expected_files, files_in, read_rows, read_yaml
from scratch_case import SharedScratchCase

STEPS = 30


class StartTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        """An experiment, whose bags and last model others start from."""
        super().setUpClass()
        cls.before = os.path.join(cls.class_scratch, "before")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", cls.before)
        assert code == 0, output
        cls.model = os.path.join(cls.before, "trial_001", "model.ddm")
        cls.bags = [os.path.join(cls.before, "trial_%03d" % k, "trial.bag") for k in range(2)]

    def run_from(self, *arguments, trials=1, out=None):
        """(exit code, output) of an experiment with seed 2."""
        return run_experiment("--preset", "debug", "--seed", 2, "--trials", trials, "--out", out or self.out,
                              *arguments)

    def assertRuns(self, *arguments, **kwargs):
        code, output = self.run_from(*arguments, **kwargs)
        self.assertEqual(code, 0, output)
        return output

    def assertRefused(self, words, *arguments):
        code, output = self.run_from(*arguments)
        self.assertEqual(code, 1, output)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.out))

    def from_both(self):
        return ["--model", self.model, "--bags"] + self.bags

    def exploratory(self, trial):
        return {row[2] for row in read_rows(self.out, "trial_%03d" % trial, "torques.csv")[1:]}

    def test_bags_count_as_trials_and_the_model_explores_in_trial_0(self):
        self.assertRuns(*self.from_both())
        self.assertEqual(files_in(self.out), expected_files(1))
        self.assertEqual([row[2] for row in read_rows(self.out, "trials.csv")[1:]], [str(3 * STEPS), str(4 * STEPS)])
        self.assertEqual(self.exploratory(0), {"0", "1"})
        start = read_yaml(self.out, "config.yaml")["start"]
        self.assertEqual((start["model"], start["bags"]), (self.model, self.bags))

    def test_the_nodes_do_the_same(self):
        nodes = self.file("nodes")
        _, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", "seed:=2", "trials:=1",
                              "runs:=" + nodes, "model:=before/trial_001/model.ddm",
                              "bags:=before/trial_000/trial.bag " + self.bags[1], folder=self.class_scratch)
        self.assertRuns(*self.from_both())
        self.assertTrue(os.path.exists(os.path.join(nodes, "summary.yaml")), output)
        names = [name for name in expected_files(1) if not name.endswith(".bag")]
        self.assertEqual(differences(nodes, self.out, names), [])

    def test_the_saved_configuration_starts_the_same_and_notices_other_files(self):
        model = shutil.copy(self.model, self.file("model.ddm"))
        self.assertRuns("--model", model, trials=0)
        config = shutil.copy(os.path.join(self.out, "config.yaml"), self.file("config.yaml"))
        self.assertRuns("--config", config, trials=0, out=self.file("again"))
        self.assertEqual(differences(self.file("again"), self.out, ["trial_000/torques.csv"]), [])
        shutil.copy(os.path.join(self.before, "trial_000", "model.ddm"), model)
        code, output = self.run_from("--config", config, trials=1)
        self.assertEqual(code, 1)
        self.assertIn(model + " has changed", output)
        code, output = self.run_from("--model", model, trials=1)
        self.assertEqual(code, 1)
        self.assertIn("start/checksums", output)
        code, output = self.run_from(trials=1)
        self.assertEqual(code, 1, output)
        self.assertIn("start/model: %s there, nothing here" % model, output)

    def test_bags_and_models_of_another_plant_are_refused(self):
        bag = self.bags[0]
        fast = self.write("fast.yaml", "plant: {dt: 0.1}\n")
        self.assertRefused(["bag " + bag, "the plant", "(dt): 0.2 ", ", 0.1 "], "--config", fast, "--bags", bag)
        small = self.write("small.yaml", "plant: {picture_size: 40}\n")
        self.assertRefused(["bag " + bag, "images: 51x51 mono8 ", ", 40x40 mono8 "], "--config", small, "--bags", bag)
        tile = ["--plant", "moving_tile"]
        self.assertRefused(["bag " + bag, "torques", ": 1 ", ", 2 "], "--bags", bag, *tile)
        self.assertRefused(["model " + self.model, "torques of 1", "plant 2"], "--model", self.model, *tile)
        coarse = self.write("coarse.yaml", "image: {size: 40}\n")
        self.assertRefused(["size 51", "image/size is 40"], "--config", coarse, "--model", self.model)

    def test_files_and_methods_that_cannot_be_started_from_are_refused(self):
        self.assertRefused(["missing.bag"], "--bags", self.file("missing.bag"))
        self.assertRefused([self.bags[0], "DDMMODEL"], "--model", self.bags[0])
        self.assertRefused(["given twice"], "--bags", self.bags[0], self.bags[0])
        self.assertRefused(["method oracle", "only ddm"], "--method", "oracle", "--model", self.model)

    def evaluate(self, *arguments, model=None):
        return call([find_program("evaluate"), "--model", model or self.model, "--preset", "debug",
                     "--out", self.out] + list(arguments))

    def test_evaluate_repeats_the_evaluation_of_the_experiment(self):
        code, output = self.evaluate("--seeds", "1:2")
        self.assertEqual(code, 0, output)
        rows = read_rows(self.out, "evaluation.csv")
        self.assertEqual(rows[0][:4], ["seed", "success", "success_strict", "final_error"])
        theirs = read_rows(self.before, "trials.csv")[2]
        self.assertEqual(rows[1][:4], [theirs[0]] + theirs[3:6])

    def test_evaluate_gives_the_same_rows_however_many_run_at_a_time(self):
        self.assertEqual(self.evaluate("--seeds", "3:8", "--jobs", "1")[0], 0)
        one = read_rows(self.out, "evaluation.csv")
        code, output = self.evaluate("--seeds", "3:8", "--jobs", "3")
        self.assertEqual(code, 0, output)
        self.assertEqual([row[:4] for row in read_rows(self.out, "evaluation.csv")], [row[:4] for row in one])
        self.assertEqual([row[0] for row in one[1:]], ["3", "4", "5", "6", "7"])
        self.assertEqual(len({row[3] for row in one[1:]}), 5)
        summary = read_yaml(self.out, "evaluation.yaml")
        self.assertEqual(summary["success"], "%d of 5" % sum(row[1] == "1" for row in one[1:]))
        self.assertIn("success_interval_95", summary)

    def test_evaluate_takes_the_model_s_own_shape(self):
        config = self.write("shape.yaml", "image: {size: 40}\nmodel: {residual: true, increments: true, order: 3}\n")
        code, output = call([find_program("train_from_bags", "ddm_model"), "--config", config, "--out",
                             self.file("shape.ddm")] + self.bags)
        self.assertEqual(code, 0, output)
        code, output = self.evaluate("--seeds", "0:2", model=self.file("shape.ddm"))
        self.assertEqual(code, 0, output)
        self.assertEqual(len(read_rows(self.out, "evaluation.csv")), 3)

    def test_evaluate_refuses_what_does_not_fit(self):
        for code, words, arguments in (
                (2, ["--seeds", "A:B", "got '3'"], ["--seeds", "3"]),
                (2, ["got '3:3'"], ["--seeds", "3:3"]),
                (2, ["got '-1:3'"], ["--seeds=-1:3"]),
                (2, ["--jobs", ">= 1", "got 0"], ["--seeds", "0:1", "--jobs", "0"]),
                (2, ["unknown plant 'robot'"], ["--seeds", "0:1", "--plant", "robot"]),
                (1, ["torques of 1", "plant 2"], ["--seeds", "0:1", "--plant", "moving_tile"])):
            actual, output = self.evaluate(*arguments)
            self.assertEqual(actual, code, output)
            for word in words:
                self.assertIn(word, output)
        self.assertFalse(os.path.exists(os.path.join(self.out, "evaluation.csv")))
