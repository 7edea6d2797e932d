# Plant `moving_tile` in a closed loop: two torques, lengths; the nodes and run_experiment give the same.
# SPDX-License-Identifier: BSD-3-Clause
from both_drivers_case import BothDriversCase
from run_files import read_rows, read_yaml

TRIALS = 1
QUICK = "training: {num_starts: 1, max_iterations: 20}\n"


class TileLoopTest(BothDriversCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "debug", "plant": "moving_tile"}, QUICK)

    def test_both_finish_with_equal_files(self):
        self.assertAllFilesAreEqual()

    def test_torques_and_states_stand_under_the_plants_own_names(self):
        torques = read_rows(self.nodes, "trial_001", "torques.csv")
        self.assertEqual(torques[0], ["step", "dx_px", "dy_px", "exploratory"])
        self.assertTrue(all(abs(float(cell)) <= 5.0 for row in torques[1:] for cell in row[1:3]))
        self.assertEqual(read_rows(self.nodes, "evaluation_001", "trajectory.csv")[0],
                         ["step", "time_s", "x_px", "y_px"])

    def test_it_is_judged_by_its_distance_to_the_goal_in_pixels(self):
        for row in read_rows(self.nodes, "trials.csv")[1:]:
            self.assertIn(row[3], ("0", "1"))
            self.assertTrue(0.0 <= float(row[5]) <= 51.0, row)
        self.assertIn("success", read_yaml(self.nodes, "summary.yaml"))
        evaluation = read_yaml(self.nodes, "config.yaml")["evaluation"]
        self.assertEqual((evaluation["tolerance"], evaluation["error_unit"]), (2.0, "px"))
