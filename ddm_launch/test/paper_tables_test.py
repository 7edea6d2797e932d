# Tables of the reproduction: what they say of made-up results.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os

from run_files import COLUMNS
from ddm_study import paper_tables
from ddm_launch.run_folder import read_sweep
from scratch_case import ScratchCase
import synthetic_run

PUBLISHED = [(100 * k, 0.5, 0.1) for k in range(0, 16)]


def write(path, header, rows):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(rows)


class PaperTablesTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.published = self.file("published.csv")
        write(self.published, ["trial", "frames", "ddm_mpc", "ddm_mpc_se"],
              [(frames // 100, frames, rate, error) for frames, rate, error in PUBLISHED])
        self.write_trials("trials.csv", lambda seed, trial: seed < 3)  # 3 of 4 seeds succeed, always
        self.write_trials("oracle/trials.csv", lambda seed, trial: True, frames=0)
        for schedule, successes in (("sequential", 1), ("v_p_only", 0), ("joint_random_init", 3)):
            self.write_trials(schedule + "/trials.csv", lambda seed, trial, n=successes: seed < n)
        self.write_trials("bfgs/trials.csv", lambda seed, trial: seed < 2 and trial > 0, trials=2)
        self.write_predictions("tile/predictions.csv", 0.04)
        for folder in ("tile_predictions", "pendulum_predictions"):
            for schedule, rmse in (("joint", 0.04), ("sequential", 0.08), ("v_p_only", 0.2),
                                   ("joint_random_init", 0.04)):
                self.write_predictions("%s/%s/predictions.csv" % (folder, schedule), rmse)

    def write_trials(self, name, success, frames=None, trials=16):
        rows = []
        for seed in range(4):
            for trial in range(trials):
                row = dict.fromkeys(COLUMNS, "0")
                row.update(seed=seed, trial=trial, frames=100 * (trial + 1) if frames is None else frames,
                           success=int(success(seed, trial)), success_strict=0, final_error=1.0,
                           train_s=0.1 * (seed + 1), plan_ms_median=0.5, plan_ms_p99=2.0 + seed)
                rows.append([row[column] for column in COLUMNS])
        write(self.file(name), COLUMNS, rows)

    def write_predictions(self, name, rmse, seeds=4):
        rows = []
        for seed in range(seeds):
            for steps in range(1, 9):
                rows.append((seed, steps, 91, rmse * (1 + 0.01 * seed), 0.1, 0.9 + 0.02 * seed, 1.0, 1.0, 2.0))
        write(self.file(name), ["seed", "steps", "num_predictions", "rmse", "rmse_repeat", "position_r2", "v_r", "v_p",
                                "train_s"], rows)

    def holds(self):
        return {row[0]: row[3] for row in paper_tables.agreement_table(self.scratch, self.published)}

    def test_success_is_measured_in_the_papers_standard_errors(self):
        rows = paper_tables.success_table(self.file("trials.csv"), self.published)
        self.assertEqual([row[0] for row in rows], [100 * k for k in range(1, 16)])  # 1600 is not in the paper
        frames, seeds, rate, error, paper, paper_error, difference = rows[0]
        self.assertEqual((frames, seeds, rate, paper, paper_error), (100, 4, 0.75, 0.5, 0.1))
        self.assertAlmostEqual(error, 0.25)  # sqrt(0.75 0.25 / 3)
        self.assertAlmostEqual(difference, 2.5)

    def test_one_point_far_below_the_curve_is_allowed_and_two_are_not(self):
        point = "success: points of the curve more than 2.5 of the paper's standard errors below it"
        self.write_trials("trials.csv", lambda seed, trial: trial != 4)
        self.assertEqual(self.holds()[point], "yes")
        self.write_trials("trials.csv", lambda seed, trial: trial not in (4, 9))
        self.assertEqual(self.holds()[point], "no")

    def test_a_curve_that_lacks_points_has_no_verdict(self):
        point = "success: points of the curve more than 2.5 of the paper's standard errors below it"
        self.write_trials("trials.csv", lambda seed, trial: True, trials=10)
        self.assertEqual(self.holds()[point], "n/a")

    def test_late_success_is_the_mean_of_each_seed_from_900_to_1500_frames(self):
        self.write_trials("trials.csv", lambda seed, trial: trial >= 8 if seed == 0 else trial in (7, 15, 14))
        late = paper_tables.late_success(read_sweep(self.file("trials.csv")))
        self.assertEqual(late[0], 1.0)
        self.assertAlmostEqual(late[1], 1.0 / 7.0)  # of trials 8 to 14 only the last

    def test_an_oracle_that_fails_once_does_not_hold(self):
        point = "oracle: success of the same planner with a perfect model"
        self.assertEqual(self.holds()[point], "yes")
        self.write_trials("oracle/trials.csv", lambda seed, trial: (seed, trial) != (2, 7), frames=0)
        self.assertEqual(self.holds()[point], "no")

    def test_solvers_are_compared_on_the_models_that_both_have(self):
        rows = paper_tables.solver_table(self.scratch)
        self.assertEqual([row[:4] for row in rows], [("lbfgs", 100, 4, 3), ("lbfgs", 200, 4, 3),
                                                     ("bfgs", 100, 4, 0), ("bfgs", 200, 4, 2)])
        self.assertAlmostEqual(rows[0][6], 0.25)  # of 0.1 to 0.4 s

    def test_the_tile_is_judged_by_mean_ratio_and_median_of_the_explained_position(self):
        rows = paper_tables.tile_rows(self.scratch)
        self.assertEqual(len(rows), 4)
        self.assertAlmostEqual(rows[1][3], 0.404)
        ratio = "tile: error 8 steps ahead over that of repeating the last frame, mean of 4 seeds"
        explained = ("tile: R^2 of the position, a quadratic map of the features on held-out frames, median of "
                     "4 seeds")
        self.assertEqual((self.holds()[ratio], self.holds()[explained]), ("yes", "yes"))
        self.write_predictions("tile/predictions.csv", 0.05)
        self.assertEqual(self.holds()[ratio], "no")

    def test_schedules_are_compared_on_the_same_seeds(self):
        self.write_predictions("tile_predictions/sequential/predictions.csv", 0.08, seeds=3)
        rows = {(row[0], row[1]): row[2:] for row in paper_tables.schedule_table(self.scratch)}
        seeds, mean, _, difference, error = rows["tile_error_ratio_8", "sequential"]
        self.assertEqual(seeds, 3)
        self.assertAlmostEqual(mean, 0.808)
        self.assertAlmostEqual(difference, 0.404)
        self.assertLess(error, 0.01)  # paired: the seeds' own spread drops out
        self.assertEqual(rows["tile_error_ratio_8", "joint"][0], 3)
        self.assertEqual(rows["pendulum_success_900_1500", "v_p_only"][3], -0.75)
        self.assertEqual(rows["tile_error_ratio_8", "joint"][3:], (0.0, 0.0))

    def test_a_schedule_counts_as_worse_only_beyond_two_standard_errors(self):
        holds = self.holds()
        self.assertEqual(holds["tile_error_ratio_8: joint against sequential"], "yes")
        self.assertEqual(holds["tile_error_ratio_8: joint against joint_random_init"], "n/a")  # not claimed
        self.assertEqual(holds["pendulum_success_900_1500: joint against v_p_only"], "yes")
        self.assertEqual(holds["pendulum_success_900_1500: joint against sequential"], "no")  # 0.5 +- 0.29

    def test_times_are_those_of_the_trials_and_pilcos_those_of_the_paper(self):
        rows = paper_tables.time_table(self.file("trials.csv"))
        training = [row for row in rows if row[0] == "training"]
        self.assertEqual([row[1] for row in training], ["100", "500", "1000", "1500"])
        self.assertAlmostEqual(training[0][2], 0.25)  # median of 0.1 ... 0.4 s
        self.assertAlmostEqual(training[0][3], 0.4)
        self.assertEqual([row[3] for row in rows if row[0].startswith("plan, 99")], [5.0])
        self.assertTrue(any(row[0].startswith("PILCO") and row[2] == 10.0 and row[4] == "h" for row in rows))

    def test_all_tables_are_written(self):
        paper_tables.write_tables(self.scratch, self.published)
        for name in ("success_rate", "schedules", "times", "tile", "agreement"):
            with open(self.file(name + ".csv")) as stream:
                self.assertGreater(len(list(csv.reader(stream))), 1, name)
        self.assertFalse(os.path.exists(self.file("pilco.csv")))

    def test_pilco_joins_the_tables_where_it_was_run(self):
        rows = [synthetic_run.pilco_row(seed, k, 1, 5.0).split(",") for seed in range(12) for k in range(10)]
        write(self.file("pilco_state", "trials.csv"), COLUMNS, rows)
        write(self.file("pilco_state", "policy_search.csv"), ["seed", "trial", "frames", "gp_s", "policy_search_s"],
              [row[:3] + ["1", "4"] for row in rows])
        agreement = paper_tables.write_tables(self.scratch, self.published, ["pilco_state"])
        self.assertEqual([row[3] for row in agreement if row[0].startswith("PILCO")], ["yes", "yes", "yes"])
        with open(self.file("pilco.csv")) as stream:
            self.assertEqual([row[1] for row in csv.reader(stream)],
                             ["policies"] + [str(k) for k in range(1, 11)] + ["2 to 6"])
        with open(self.file("times.csv")) as stream:
            text = stream.read()
        self.assertIn("\n\"PILCO on 2-D features, 10 trials\",1000,10,", text)
        self.assertIn("\n\"PILCO, state: of it policy search\",1250,4,4,s,", text)
