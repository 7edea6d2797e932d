# The whole loop with the real nodes: files, terminal, bags, and how it resumes.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import signal

from processes import roslaunch, run_experiment, start_roslaunch
from run_files import differences, expected_files, files_in, read_bag, read_bytes, read_rows, read_yaml
from scratch_case import SharedScratchCase

TRIALS = 2


class LoopTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.reference = os.path.join(cls.class_scratch, "reference")
        cls.code, cls.output = roslaunch(cls.class_scratch, *cls.experiment(cls.reference, TRIALS))

    @staticmethod
    def experiment(out, trials):
        return ["experiment.launch", "preset:=debug", "plant:=pendulum", "seed:=1", "trials:=%d" % trials, "runs:=" + out]

    def assertSameAsOneProcess(self, out, trials):
        """Everything but bags, whose stamps are another simulated time, and what tells wall times."""
        one_process = self.file("one_process")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", trials, "--out", one_process)
        self.assertEqual(code, 0, output)
        names = [name for name in expected_files(trials) if not name.endswith((".bag", "config.yaml"))]
        self.assertEqual(differences(one_process, out, names), [])

    def test_all_files_of_the_contract_are_written_and_the_terminal_shows_each_trial(self):
        self.assertEqual(self.code, 0, self.output)
        self.assertEqual(files_in(self.reference), expected_files(TRIALS), self.output)
        summary = read_yaml(self.reference, "summary.yaml")
        self.assertIs(summary["finished"], True)
        self.assertEqual((summary["preset"], summary["seed"], summary["trials"]), ("debug", 1, TRIALS))
        for k in range(TRIALS + 1):
            self.assertRegex(self.output, r"trial +%d/%d +%d frames" % (k, TRIALS, 30 * (k + 1)))
        self.assertIn("results: %s/trials.csv" % self.reference, self.output)
        for word in ("WARN", "ERROR", "FATAL", "Traceback"):
            self.assertNotIn(word, self.output)

    def test_each_bag_holds_a_torque_for_each_image_and_the_goal_and_time_never_runs_backwards(self):
        images = []
        for k in range(TRIALS + 1):
            stamps = read_bag(os.path.join(self.reference, "trial_%03d" % k, "trial.bag"))
            self.assertEqual(sorted(stamps), ["camera/image_raw", "goal_image", "torque"])
            self.assertEqual(len(stamps["camera/image_raw"]), 30)
            self.assertEqual(stamps["camera/image_raw"], stamps["torque"])
            self.assertEqual(len(stamps["goal_image"]), 1)
            images += stamps["camera/image_raw"]
        self.assertEqual(images, sorted(set(images)))

    def test_the_same_command_with_more_trials_resumes_in_a_folder_that_may_be_relative(self):
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", self.out)
        self.assertEqual(code, 0, output)  # its folder is the same, so that either driver can go on
        # relative: meant from where roslaunch was called, though nodes run elsewhere
        _, output = roslaunch(self.scratch, *self.experiment("out", 1), folder=self.scratch)
        self.assertIn("after trial 0", output)
        self.assertEqual(files_in(self.out), expected_files(1), output)
        self.assertSameAsOneProcess(self.out, 1)

    def test_an_interrupted_experiment_ends_at_once_without_a_verdict_and_goes_on_later(self):
        launch = start_roslaunch(self.scratch, *self.experiment(self.out, 999))
        self.addCleanup(launch.stop)
        launch.waitForText("trial  1/999", 30.0)
        launch.send(signal.SIGINT)
        launch.waitForEnd(20.0)
        self.assertNotIn("summary.yaml", files_in(self.out))
        finished = len(read_rows(self.out, "trials.csv")) - 1
        _, output = roslaunch(self.scratch, *self.experiment(self.out, finished))
        self.assertIn("after trial %d" % (finished - 1), output)
        self.assertSameAsOneProcess(self.out, finished)

    def test_a_trial_that_is_recorded_or_trained_already_is_not_repeated(self):
        for said, removed in (("trained already", []), ("recorded already", ["training.yaml", "model.ddm"])):
            shutil.rmtree(self.out, ignore_errors=True)
            shutil.copytree(self.reference, self.out)  # as if it had been killed in the last evaluation or training
            for name in ["summary.yaml"] + ["trial_%03d/%s" % (TRIALS, name) for name in removed]:
                os.remove(os.path.join(self.out, name))
            shutil.rmtree(os.path.join(self.out, "evaluation_%03d" % TRIALS))
            rows = read_bytes(self.out, "trials.csv").splitlines(keepends=True)
            with open(os.path.join(self.out, "trials.csv"), "wb") as stream:
                stream.writelines(rows[:-1])
            _, output = roslaunch(self.scratch, *self.experiment(self.out, TRIALS))
            self.assertIn(said, output)
            bag = "trial_%03d/trial.bag" % TRIALS
            self.assertEqual(read_bytes(self.out, bag), read_bytes(self.reference, bag))
            self.assertSameAsOneProcess(self.out, TRIALS)
