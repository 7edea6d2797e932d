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
from run_files import files_in, read_bag, read_rows  # noqa: E402
from scratch_case import SharedScratchCase  # noqa: E402

DEBUG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "config", "presets", "debug.yaml")
STEPS = 30
VERDICT = r"final error \d+\.\d+ deg: .*reached"


def train(out, *bags):
    return call([find_program("train_from_bags", "ddm_model"), "--config", DEBUG, "--out", out] + list(bags))


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
        try:
            recorder.waitForText("Subscribing to /goal_image", 20.0)
            _, cls.output = roslaunch(cls.class_scratch, "record.launch", "preset:=debug", "seed:=1",
                                      "num_steps:=%d" % STEPS, "bag:=" + cls.bag, port=0)
            recorder.send(signal.SIGINT)
            recorder.waitForEnd(20.0)
        finally:
            recorder.stop()
        cls.trained = train(cls.model, cls.bag)

    def assertIsTrial(self, bag):
        stamps = read_bag(bag)
        self.assertEqual(len(stamps["camera/image_raw"]), STEPS)
        self.assertEqual(stamps["camera/image_raw"], stamps["torque"])
        self.assertEqual(len(stamps["goal_image"]), 1)

    def test_a_random_trial_is_recorded(self):
        self.assertIsTrial(self.bag)
        self.assertIn("recorded: " + self.bag, self.output)

    def test_the_random_trial_is_that_of_an_experiment(self):
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", self.file("run"))
        self.assertEqual(code, 0, output)
        self.assertEqual(["%.17g" % torque for torque in self.torquesOf(self.bag)],
                         [row[1] for row in read_rows(self.file("run"), "trial_000", "torques.csv")[1:]])

    @staticmethod
    def torquesOf(path):
        with rosbag.Bag(path) as bag:
            return [message.torque[0] for _, message, _ in bag.read_messages(["torque"])]

    def test_a_model_is_trained_from_the_bag(self):
        code, output = self.trained
        self.assertEqual(code, 0, output)
        self.assertIn("frames: %d" % STEPS, output)
        self.assertIn("goal: yes", output)

    def test_a_bag_of_plain_rosbag_record_gives_the_same_model(self):
        code, output = train(self.file("plain.ddm"), self.plain)
        self.assertEqual(code, 0, output)
        self.assertIn("frames: %d" % STEPS, output)
        with open(self.model, "rb") as ours, open(self.file("plain.ddm"), "rb") as plain:
            self.assertEqual(ours.read(), plain.read())

    def test_a_saved_model_drives_the_plant_and_the_verdict_is_told(self):
        _, output = roslaunch(self.scratch, "control.launch", "preset:=debug", "num_steps:=%d" % STEPS,
                              "model:=" + self.model)
        self.assertRegex(output, VERDICT)
        self.assertIn("%d torques" % STEPS, output)
        self.assertFalse([name for name in files_in(self.scratch) if ".bag" in name])

    def test_a_trial_with_a_model_and_exploration_is_recorded(self):
        bag = self.file("explored.bag")
        _, output = roslaunch(self.scratch, "record.launch", "preset:=debug", "num_steps:=%d" % STEPS, "epsilon:=0.5",
                              "bag:=explored.bag", "model:=" + self.model, folder=self.scratch)
        self.assertIn("recorded: " + bag, output)
        self.assertIsTrial(bag)
        code, output = train(self.file("both.ddm"), self.bag, bag)
        self.assertEqual(code, 0, output)
        self.assertIn("frames: %d" % (2 * STEPS), output)

    def test_another_plant_can_be_recorded(self):
        bag = self.file("gravity.bag")
        _, output = roslaunch(self.scratch, "record.launch", "preset:=debug", "plant:=pendulum_gravity",
                              "num_steps:=%d" % STEPS, "bag:=" + bag)
        self.assertIsTrial(bag)
        self.assertTrue(all(abs(torque) <= 2.5 for torque in self.torquesOf(bag)), output)

    def test_a_model_that_cannot_be_read_is_named(self):
        with open(self.file("damaged.ddm"), "wb") as stream:
            stream.write(b"DDMMODEL nonsense")
        _, output = roslaunch(self.scratch, "control.launch", "preset:=debug", "model:=" + self.file("damaged.ddm"))
        self.assertRegex(output, r"FATAL.*%s" % self.file("damaged.ddm"))
        self.assertIn("exit code 1", output)

    def test_a_bag_that_cannot_be_written_is_named(self):
        bag = self.file("no/such/folder/x.bag")
        _, output = roslaunch(self.scratch, "record.launch", "preset:=debug", "num_steps:=%d" % STEPS, "bag:=" + bag)
        self.assertRegex(output, r"FATAL.*%s" % bag)
        self.assertIn("exit code 1", output)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "record_and_control_test", RecordAndControlTest)
