# Reading never writes: a finished run keeps every byte, whatever reads it and whatever is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import roslib.packages

from ddm_launch.folder_lock import FolderLock
from processes import call, find_program, roslaunch, run_experiment
from run_files import changes, fingerprint
from scratch_case import SharedScratchCase

PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
TRIALS = 1
LIMIT_S = 240.0  # of a program on a machine that has much else to do
QUICK = "training: {max_iterations: 20, num_starts: 1}\nprediction: {training_frames: 60, held_out_frames: 30}\n"

# Each program: what it reads, what it writes. Programs that read a run or a prediction are called below.
READS_A_RUN = {
    "ddm_launch": {
        "evaluate": ("a model", "evaluation.csv and .yaml in --out"),
        "feature_space": ("config.yaml, bags, a model, torques.csv", "--out"),
        "film_strip": ("config.yaml, trials.csv, an evaluation", "--out, --gif"),
        "learning_curve": ("trials.csv", "--out"),
        "pendulum_feature_space": ("a model, the table of feature_space", "--out"),
        "benchmark_kernels": ("config.yaml, trials.csv, bags, the last model", "--benchmark_out")},
    "ddm_model": {
        "export": ("a model", "--out"),
        "inspect": ("a model, bags", "report.html, verdict.yaml and pictures in --out"),
        "read_bags": ("bags", "their frames in --out"),
        "train_from_bags": ("config.yaml, bags", "--out")}}
READS_A_PREDICTION = {
    "feature_plane": ("config.yaml, features.csv, a model", "--out"),
    "prediction_strip": ("config.yaml, strip.csv, a model", "--out")}
READS_TABLES = {name: ("tables that others collect from runs", "--out") for name in (
    "ablation_compared", "angle_trajectories", "nuisances_compared", "schedules_compared", "success_rate",
    "trajectory_distributions")}
WRITES_A_RUN = {
    "run_experiment": "--out, from its first result on",
    "prediction_experiment": "--out, from its first result on",
    "robot_check": "robot_check.yaml in the run that it checks",
    "sweep": "--out, with a run for each seed"}
WRITES_ITS_OWN = {name: "--out, with runs of its own" for name in (
    "fault_table", "qa", "reproduce_efficient", "reproduce_paper")}


class ReadingTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder, cls.prediction = (os.path.join(cls.class_scratch, name) for name in ("run", "prediction"))
        cls.config = os.path.join(cls.class_scratch, "quick.yaml")
        with open(cls.config, "w") as stream:
            stream.write(QUICK)
        for name, plant, arguments in (("run_experiment", "pendulum", ["--trials", TRIALS, "--out", cls.run_folder]),
                                       ("prediction_experiment", "moving_tile", ["--out", cls.prediction])):
            code, output = call([find_program(name), "--preset", "debug", "--plant", plant, "--seed", 1,
                                 "--config", cls.config] + arguments)
            assert code == 0, output
        cls.model = os.path.join(cls.run_folder, "trial_001", "model.ddm")
        cls.bags = [os.path.join(cls.run_folder, "trial_%03d" % k, "trial.bag") for k in range(TRIALS + 1)]

    def setUp(self):
        super().setUp()
        self.before = {folder: fingerprint(folder) for folder in (self.run_folder, self.prediction)}

    def assertUnchanged(self, words):
        for folder, before in self.before.items():
            self.assertEqual(changes(before, fingerprint(folder)), [], words)

    def assertSummedUp(self, words):
        """Only the time of summary.yaml has changed, by which demo.sh knows that this call found the experiment finished."""
        summary = os.path.join(self.run_folder, "summary.yaml")
        before = self.before[self.run_folder][summary][1]
        self.assertGreater(os.stat(summary).st_mtime_ns, before)
        os.utime(summary, ns=(before, before))
        self.assertUnchanged(words)

    def assertReads(self, package, name, *arguments):
        """The program succeeds and leaves the folders as they are."""
        code, output = call([find_program(name, package)] + list(arguments), LIMIT_S, folder=self.scratch)
        self.assertEqual(code, 0, output)
        self.assertUnchanged([name] + list(arguments))

    def experiment(self, out, seed=1, trials=TRIALS):
        return ["--preset", "debug", "--seed", seed, "--trials", trials, "--config", self.config, "--out", out]

    def assertRefused(self, word, folder, *arguments):
        """run_experiment fails, says the word, and leaves the folder as it is, or leaves none."""
        before = fingerprint(folder) if os.path.exists(folder) else {}
        code, output = run_experiment(*arguments)
        self.assertNotEqual(code, 0, output)
        self.assertIn(word, output)
        self.assertEqual(changes(before, fingerprint(folder) if os.path.exists(folder) else {}), [], output)

    def copyRun(self):
        shutil.copytree(self.run_folder, self.out)
        return self.out

    def test_every_program_is_in_one_of_the_lists(self):
        listed = (set(READS_A_RUN["ddm_launch"]) | set(READS_A_PREDICTION) | set(READS_TABLES) | set(WRITES_A_RUN)
                  | set(WRITES_ITS_OWN))
        scripts = {name for name in os.listdir(os.path.join(PACKAGE, "scripts")) if "." not in name}
        scripts -= {"figure", "learning_curve_node"}  # figures have names of their own, nodes read topics
        self.assertEqual(scripts - listed, set())

    def test_programs_that_read_a_run_leave_it_as_it_is(self):
        calls = {
            "evaluate": ["--model", self.model, "--plant", "pendulum", "--seeds", "0:2", "--preset", "debug",
                         "--config", os.path.join(self.run_folder, "config.yaml"), "--out", self.file("evaluated")],
            "feature_space": [self.run_folder, "--trial", TRIALS, "--step", 20, "--out", self.file("space.csv")],
            "film_strip": [self.run_folder],
            "learning_curve": [self.run_folder],
            "pendulum_feature_space": [self.file("space.csv"), "--model", self.model, "--out", self.file("space.png")],
            "benchmark_kernels": [self.run_folder, "--benchmark_filter=encode"],
            "export": ["--model", self.model, "--out", self.file("model.npz")],
            "inspect": ["--model", self.model, "--out", self.file("report")] + self.bags,
            "read_bags": ["--image-size", 51, "--out", self.file("frames")] + self.bags,
            "train_from_bags": ["--config", os.path.join(self.run_folder, "config.yaml"), "--out",
                                self.file("again.ddm")] + self.bags}
        self.assertEqual(set(calls), {name for names in READS_A_RUN.values() for name in names})
        for package, names in READS_A_RUN.items():
            for name in sorted(names):
                if name == "benchmark_kernels" and not roslib.packages.find_node(package, name):
                    print("NOT TESTED: benchmark_kernels, which is not built without Google Benchmark")
                    continue
                self.assertReads(package, name, *calls[name])

    def test_programs_that_read_a_prediction_leave_it_as_it_is(self):
        for name in sorted(READS_A_PREDICTION):
            self.assertReads("ddm_launch", name, self.prediction, "--out", self.file(name + ".png"))

    def test_launches_that_read_a_run_leave_it_as_it_is(self):
        for launch in (["control.launch", "preset:=debug", "num_steps:=5", "model:=" + self.model],
                       ["record.launch", "preset:=debug", "num_steps:=5", "model:=" + self.model,
                        "bag:=" + self.file("new.bag")],
                       ["replay.launch", "preset:=debug", "model:=" + self.model, "bag:=" + self.bags[0], "rate:=0",
                        "out:=" + self.file("replay.csv")]):
            _, output = roslaunch(self.scratch, *launch, limit_s=LIMIT_S)
            self.assertUnchanged(output)
            self.assertNotIn("exit code", output)

    def test_a_finished_experiment_is_summed_up_and_stays_as_it_is(self):
        code, output = run_experiment(*self.experiment(self.run_folder))
        self.assertEqual(code, 0, output)
        self.assertIn("%d models trained" % (TRIALS + 1), output)
        self.assertSummedUp(output)
        _, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", "seed:=1", "trials:=%d" % TRIALS,
                              "config:=" + self.config, "runs:=" + self.run_folder)
        self.assertIn("%d models trained" % (TRIALS + 1), output)
        self.assertSummedUp(output)

    def test_a_refused_experiment_leaves_the_run_as_it_is(self):
        folder = self.copyRun()
        more = TRIALS + 1
        self.assertRefused("experiment/seed: 1 there, 2 here", folder, *self.experiment(folder, 2, more))
        self.assertRefused("experiment/plant", folder, *self.experiment(folder, 1, more), "--plant", "pendulum_gravity")
        lock = FolderLock(folder)
        self.assertRefused("is running", folder, *self.experiment(folder, 1, more))
        lock.release()
        bag = os.path.join(folder, "trial_000", "trial.bag")
        size = os.path.getsize(bag)
        os.truncate(bag, size // 2)
        self.assertRefused(bag, folder, *self.experiment(folder, 1, more))
        os.remove(bag)
        self.assertRefused(bag, folder, *self.experiment(folder, 1, more))
        table = os.path.join(folder, "trials.csv")
        with open(table) as stream:
            text = stream.read()
        self.write(table, text.replace("1", "2"))
        self.assertRefused("trials.csv", folder, *self.experiment(folder, 1, more))

    def test_a_refused_experiment_makes_no_folder(self):
        self.assertRefused("windmill", self.out, *self.experiment(self.out), "--plant", "windmill")
        self.assertRefused("missing.ddm", self.out, *self.experiment(self.out), "--model", self.file("missing.ddm"))
        self.assertRefused("no bag", self.out, *self.experiment(self.out), "--bags", self.write("no.bag", "no bag"))

    def test_nodes_that_never_appear_leave_the_run_as_it_is_and_make_no_folder(self):
        config = self.write("impatient.yaml", QUICK + "experiment: {timeout: 2.0}\n")
        folder, new = self.copyRun(), self.file("new")
        before = fingerprint(folder)
        for runs in (folder, new):
            _, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", "seed:=1",
                                  "trials:=%d" % (TRIALS + 1), "config:=" + config, "runs:=" + runs,
                                  "simulator_here:=false")
            self.assertIn("REQUIRED process [experiment_node", output)
            self.assertIn("exit code 1", output)
        self.assertEqual(changes(before, fingerprint(folder)), [])
        self.assertFalse(os.path.exists(new))
