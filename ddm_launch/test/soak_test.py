# A short soak of both runs finds nothing, and a frame that is taken out of one of its bags is lost.
# SPDX-License-Identifier: BSD-3-Clause
import os
from unittest import mock

import rosbag

from ddm_launch.command import Failure
from ddm_qa import soak
from ddm_qa.soak_targets import count_frames
from processes import call, find_program
from run_files import read_bytes, read_rows
from scratch_case import ScratchCase

NODES = {"experiment_node", "master", "model_node", "mpc_node", "rosout", "sim_node", "trial_recorder"}


class SoakTest(ScratchCase):
    def test_both_runs_leave_tables_and_a_figure_and_lockstep_loses_no_frame(self):
        code, output = call([find_program("soak"), "--trials", "5", "--minutes", "0.3", "--steps", "12",
                             "--out", self.out], limit_s=200.0)
        targets = read_rows(self.out, "targets.csv")[1:]
        self.assertEqual(code, 0 if all(row[3] == "1" for row in targets) else 1, output)
        for run in ("lockstep", "real_time"):
            self.assertEqual({row[1] for row in targets if row[0] == run},
                             {"lost frames"} | {target + node for target in ("resident memory of ", "open files of ")
                                                for node in NODES}, output)
        self.assertIn(["lockstep", "lost frames", "0 of 240", "1"], targets, output)
        samples = {(row[1], row[2]) for row in read_rows(self.out, "soak.csv") if row[0] == "lockstep"}
        self.assertLessEqual(samples, {(node, str(trial)) for node in NODES for trial in range(6)})
        self.assertLessEqual({(node, "5") for node in NODES}, samples)  # of short trials some may be missed, not the last
        self.assertEqual(read_bytes(self.out, "soak.png")[:4], b"\x89PNG")
        self.lose_a_frame()

    def test_a_time_too_short_for_two_trials_is_named(self):
        run = soak.SoakRun(soak.Soak("real_time", "", [], None, 1.0), self.out)
        run.samples = [soak.Sample("real_time", "master", 0, 1.0, 1000, 10)]
        with mock.patch.object(soak, "start_roslaunch", lambda *_, **__: mock.Mock(output="")), \
                mock.patch.object(run, "follow"), self.assertRaises(Failure) as caught:
            run.make(print)
        self.assertIn("--minutes", str(caught.exception))

    def lose_a_frame(self):
        """In a bag of the run, the ninth image."""
        folder = os.path.join(self.out, "lockstep", "run")
        path = os.path.join(folder, "trial_003", "trial.bag")
        with rosbag.Bag(path) as bag:
            messages = list(bag.read_messages())
        images = [number for number, message in enumerate(messages) if message.topic == "camera/image_raw"]
        del messages[images[8]]
        with rosbag.Bag(path, "w") as bag:
            for topic, message, stamp in messages:
                bag.write(topic, message, stamp)
        self.assertEqual([(row["trial"], row["part"]) for row in count_frames("lockstep", folder, 6) if row["lost"]],
                         [(3, "trial")])
