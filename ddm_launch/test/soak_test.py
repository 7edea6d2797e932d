# A short `qa soak` of both runs finds nothing, and a frame that is removed from one of its bags is lost.
# SPDX-License-Identifier: BSD-3-Clause
import os

import rosbag

from ddm_qa import soak
from processes import call, find_program
from run_files import read_rows
from scratch_case import ScratchCase

NODES = {"experiment_node", "master", "model_node", "mpc_node", "rosout", "sim_node", "trial_recorder"}


class SoakTest(ScratchCase):
    def test_both_runs_leave_tables_and_lockstep_loses_no_frame(self):
        code, output = call([find_program("qa"), "soak", "--trials", "5", "--minutes", "0.2", "--steps", "10",
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
        self.lose_a_frame()

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
        self.assertEqual([(row.trial, row.part) for row in soak.count_frames("lockstep", folder, 6) if row.lost],
                         [(3, "trial")])
