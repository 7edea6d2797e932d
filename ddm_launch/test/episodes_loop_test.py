# Episodes, time to the goal, a choice of the delay and blur: the nodes and run_experiment give the same.
# SPDX-License-Identifier: BSD-3-Clause
from both_drivers_case import BothDriversCase
from run_files import read_rows

TRIALS = 1
CONFIG = """\
model: {blur: 1.0}
training: {max_delay: 1}
mpc: {cost: time}
trial: {episodes: 2}
"""


class EpisodesLoopTest(BothDriversCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "debug", "plant": "pendulum"}, CONFIG)

    def test_both_finish_with_equal_files(self):
        self.assertAllFilesAreEqual()
        self.assertEqualFiles(["trial_%03d/episode_001/%s" % (k, name) for k in range(TRIALS + 1)
                               for name in ("torques.csv", "trajectory.csv")])

    def test_a_model_learns_from_both_episodes_which_begin_in_different_states(self):
        self.assertEqual([row[2] for row in read_rows(self.nodes, "trials.csv")[1:]], ["60", "120"])
        starts = {tuple(read_rows(self.nodes, "trial_%03d" % k, *episode, "trajectory.csv")[1][2:])
                  for k in range(TRIALS + 1) for episode in ((), ("episode_001",))}
        self.assertEqual(len(starts), 2 * (TRIALS + 1))
