#!/usr/bin/python3
# record.launch, train_from_bags and control.launch: from bags to a model that drives, without an experiment.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import sys

import rosbag
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import Process, call, find_program, roslaunch, run_experiment  # noqa: E402
from run_files import files_in, read_bag, read_bytes, read_rows  # noqa: E402
from scratch_case import SharedScratchCase  # noqa: E402

DEBUG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "config", "presets", "debug.yaml")
STEPS = 30


class RecordAndControlTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        """One random bag, recorded by trial_recorder and by plain `rosbag record` at once, and its model."""
        super().setUpClass()
        cls.bag, cls.plain, cls.model = (os.path.join(cls.class_scratch, name)
                                         for name in ("random.bag", "plain.bag", "model.ddm"))
        # On the master of this test, which is there before the launch: so nothing is missed.
        recorder = Process([find_program("record", "rosbag"), "-O", cls.plain, "/camera/image_raw", "/torque",
                            "/goal_image"])
        with recorder:
            recorder.waitForText("Subscribing to /goal_image", 20.0)
            _, cls.output = roslaunch(cls.class_scratch, "record.launch", "preset:=debug", "seed:=1",
                                      "num_steps:=%d" % STEPS, "bag:=" + cls.bag, port=0)
            recorder.send(signal.SIGINT)
            recorder.waitForEnd(20.0)
        cls.train(cls.model, cls.bag)

    @staticmethod
    def train(out, *bags):
        code, output = call([find_program("train_from_bags", "ddm_model"), "--config", DEBUG, "--out", out, *bags])
        assert code == 0 and "frames: %d" % (len(bags) * STEPS) in output and "goal: yes" in output, output

    def assertIsTrial(self, bag):
        stamps = read_bag(bag)
        self.assertEqual(len(stamps["camera/image_raw"]), STEPS)
        self.assertEqual(stamps["camera/image_raw"], stamps["torque"])
        self.assertEqual(len(stamps["goal_image"]), 1)

    def test_a_random_trial_is_recorded_which_is_that_of_an_experiment(self):
        self.assertIn("recorded: " + self.bag, self.output)
        self.assertIsTrial(self.bag)
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", self.file("run"))
        self.assertEqual(code, 0, output)
        with rosbag.Bag(self.bag) as bag:
            torques = ["%.17g" % message.torque[0] for _, message, _ in bag.read_messages(["torque"])]
        self.assertEqual(torques, [row[1] for row in read_rows(self.file("run"), "trial_000", "torques.csv")[1:]])

    def test_a_bag_of_plain_rosbag_record_gives_the_same_model(self):
        self.train(self.file("plain.ddm"), self.plain)
        self.assertEqual(read_bytes(self.model), read_bytes(self.file("plain.ddm")))

    def test_a_saved_model_drives_the_plant_and_the_verdict_is_told(self):
        _, output = roslaunch(self.scratch, "control.launch", "preset:=debug", "num_steps:=%d" % STEPS,
                              "model:=" + self.model)
        self.assertRegex(output, r"final error \d+\.\d+ deg: .*reached")
        self.assertIn("%d torques" % STEPS, output)
        self.assertFalse([name for name in files_in(self.scratch) if ".bag" in name])

    def test_a_trial_with_a_model_and_exploration_is_recorded_in_a_folder_that_may_be_relative(self):
        bag = self.file("explored.bag")
        _, output = roslaunch(self.scratch, "record.launch", "preset:=debug", "num_steps:=%d" % STEPS, "epsilon:=0.5",
                              "bag:=explored.bag", "model:=" + self.model, folder=self.scratch)
        self.assertIn("recorded: " + bag, output)
        self.assertIsTrial(bag)
        self.train(self.file("both.ddm"), self.bag, bag)

    def test_a_bag_that_cannot_be_written_is_named(self):
        bag = self.file("no/such/folder/x.bag")
        _, output = roslaunch(self.scratch, "record.launch", "preset:=debug", "num_steps:=%d" % STEPS, "bag:=" + bag)
        self.assertRegex(output, r"FATAL.*%s" % bag)
        self.assertIn("exit code 1", output)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "record_and_control_test", RecordAndControlTest)
