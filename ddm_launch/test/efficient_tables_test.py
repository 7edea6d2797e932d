# Tables of reproduce_efficient: what they say of made-up results, and which targets these reach.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os

from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep
from ddm_study import efficient_tables
import figure_case
from run_files import COLUMNS


class EfficientTablesTest(figure_case.FigureCase):
    def writeTrials(self, name, seeds, trials, success, strict=None, frames=lambda trial: 100 * (trial + 1)):
        """success, strict: of (seed, trial). A training takes as many seconds as the seed's number and a tenth."""
        rows = []
        for seed in seeds:
            for trial in range(trials):
                row = dict.fromkeys(COLUMNS, "0")
                row.update(seed=seed, trial=trial, frames=frames(trial), success=int(success(seed, trial)),
                           success_strict=int((strict or success)(seed, trial)), final_error=1.0,
                           train_s=seed + 0.1, plan_ms_p99=2.0 + seed + 0.5 * trial)
                rows.append(",".join(str(row[column]) for column in COLUMNS))
        return self.writeLines(name, ",".join(COLUMNS), *rows)

    def writeSeed(self, seed, wall_s):
        """What a sweep leaves of a seed."""
        self.writeLines("sweep/seed_%04d/summary.yaml" % seed, "finished: true", "wall_s: %g" % wall_s)

    def readTable(self, name):
        with open(self.file(name), newline="") as stream:
            return list(csv.DictReader(stream))

    def test_success_stands_beside_its_interval_strict_and_not(self):
        path = self.writeTrials("trials.csv", range(20), 2, lambda seed, trial: trial == 1,
                                lambda seed, trial: trial == 1 and seed < 10)
        first, second = efficient_tables.success_rows(read_sweep(path))
        self.assertEqual((first[:4], second[:3]), ((100, 20, 0.0, 0.0), (200, 20, 1.0)))
        self.assertAlmostEqual(first[4], 0.1611, delta=5e-5)
        self.assertAlmostEqual(second[3], 0.8389, delta=5e-5)
        self.assertEqual(second[5], 0.5)
        self.assertAlmostEqual(second[6] + second[7], 1.0)

    def test_a_file_without_strict_success_leaves_its_cells_empty(self):
        path = self.writeLines("trials.csv", "seed,trial,frames,success,final_error", "0,0,100,1,2")
        self.assertEqual(efficient_tables.success_rows(read_sweep(path))[0][5:], ("", "", ""))

    def test_times_are_those_of_whole_experiments_with_median_and_largest(self):
        path = self.writeTrials("trials.csv", (3, 4, 5), 2, lambda seed, trial: True)
        for seed, wall_s in ((3, 10.0), (4, 30.0), (5, 20.0)):
            self.writeSeed(seed, wall_s)
        rows = efficient_tables.time_rows(path, self.file("sweep"))
        self.assertEqual([row[0] for row in rows], [3, 4, 5, "median", "largest"])
        for row, expected in zip(rows, ((6.2, 10.0, 5.5), (8.2, 30.0, 6.5), (10.2, 20.0, 7.5), (8.2, 20.0, 6.5),
                                        (10.2, 30.0, 7.5))):
            for value, number in zip(row[1:], expected):
                self.assertAlmostEqual(value, number)

    def test_the_wall_time_of_an_interrupted_experiment_is_not_known(self):
        path = self.writeTrials("trials.csv", (3, 4, 5), 2, lambda seed, trial: True)
        self.writeSeed(3, 10.0)
        self.writeSeed(4, 1.0)  # there is no summary of seed 5
        rows = efficient_tables.time_rows(path, self.file("sweep"), resumed=[4])
        self.assertEqual([row[2] for row in rows], [10.0, "", "", 10.0, 10.0])

    def writeAblation(self):
        """Four seeds, three trials. The preset fails in trial 0 of seed 0; without steps seeds 0 and 1 fail there, and
        seed 3 in trial 2."""
        self.writeTrials("ablation/preset/trials.csv", range(4), 3, lambda seed, trial: (seed, trial) != (0, 0))
        self.writeTrials("ablation/steps/trials.csv", range(4), 3,
                         lambda seed, trial: (seed, trial) not in ((0, 0), (1, 0), (3, 2)))
        return {"preset": "Full preset", "steps": "Without steps"}

    def test_an_ablation_is_the_difference_paired_by_seed(self):
        rows = efficient_tables.variant_rows(self.scratch, "ablation", self.writeAblation())
        self.assertEqual([row[:4] for row in rows], [(variant, label, frames, 4) for variant, label in (
            ("preset", "Full preset"), ("steps", "Without steps")) for frames in (
                "100", "200", "300", "100 to 300", "200 to 300")])
        by_key = {(row[0], row[2]): row[4:] for row in rows}
        self.assertEqual(by_key["preset", "100"][0], 0.75)
        self.assertEqual([by_key["preset", frames][2:] for frames in ("100", "100 to 300")], [(0.0, 0.0, "", "")] * 2)
        success, error, difference, difference_error, p, p_holm = by_key["steps", "100"]
        self.assertEqual((success, difference), (0.5, -0.25))
        self.assertAlmostEqual(error, (0.25 / 3.0) ** 0.5)
        self.assertAlmostEqual(difference_error, 0.25)  # 0, -1, 0, 0: s = 1/2
        self.assertEqual((p, p_holm), (1.0, 1.0))  # one pair differs
        self.assertAlmostEqual(by_key["steps", "100 to 300"][0], 9.0 / 12.0)
        self.assertAlmostEqual(by_key["steps", "100 to 300"][2], -2.0 / 12.0)
        self.assertAlmostEqual(by_key["steps", "200 to 300"][2], -1.0 / 8.0)
        self.assertAlmostEqual(by_key["steps", "200 to 300"][3], 0.125)

    def test_only_seeds_of_both_count_in_an_ablation(self):
        labels = self.writeAblation()
        self.writeTrials("ablation/steps/trials.csv", range(1, 6), 3, lambda seed, trial: False)
        rows = [row for row in efficient_tables.variant_rows(self.scratch, "ablation", labels) if row[0] == "steps"]
        self.assertEqual([(row[3], row[4], row[6], row[7]) for row in rows], [(3, 0.0, -1.0, 0.0)] * 5)

    def test_an_ablation_without_a_common_seed_is_refused(self):
        labels = self.writeAblation()
        self.writeTrials("ablation/steps/trials.csv", range(7, 9), 3, lambda seed, trial: True)
        with self.assertRaisesRegex(Failure, "100 frames .*steps"):
            efficient_tables.variant_rows(self.scratch, "ablation", labels)

    def test_other_variants_are_compared_with_the_same_reference_at_frames_that_each_has(self):
        self.writeAblation()
        self.writeTrials("tried/ensemble/trials.csv", range(4), 2, lambda seed, trial: seed != 3)
        self.writeTrials("tried/starts/trials.csv", range(4), 3, lambda seed, trial: True)
        rows = efficient_tables.variant_rows(self.scratch, "tried", {"preset": "Full preset", "ensemble": "Ensemble",
                                                                     "starts": "Starts"})
        self.assertEqual([row[:3] for row in rows], [
            (variant, label, frames) for variant, label in (
                ("preset", "Full preset"), ("ensemble", "Ensemble"), ("starts", "Starts"))
            for frames in ("100", "200", "100 to 200")])
        differences = {(row[0], row[2]): row[6] for row in rows}
        self.assertEqual((differences["ensemble", "100"], differences["ensemble", "200"]), (0.0, -0.25))
        self.assertEqual(differences["starts", "100"], 0.25)

    def test_several_variants_share_the_level_of_their_tests(self):
        self.writeTrials("ablation/preset/trials.csv", range(6), 1, lambda seed, trial: True)
        for name, failures in (("all", 6), ("five", 5), ("none", 0)):
            self.writeTrials("ablation/%s/trials.csv" % name, range(6), 1, lambda seed, trial: seed >= failures)
        rows = efficient_tables.variant_rows(self.scratch, "ablation", dict.fromkeys(("preset", "none", "five", "all"), "-"))
        self.assertEqual({row[0]: row[8:] for row in rows}, {
            "preset": ("", ""), "none": (1.0, 1.0), "five": (2.0 / 32, 4.0 / 32), "all": (2.0 / 64, 6.0 / 64)})

    def test_variants_without_a_common_number_of_frames_are_refused(self):
        self.writeAblation()
        self.writeTrials("tried/ensemble/trials.csv", range(4), 2, lambda seed, trial: True,
                         frames=lambda trial: 30 * (trial + 1))
        with self.assertRaisesRegex(Failure, "tried.*ensemble"):
            efficient_tables.variant_rows(self.scratch, "tried", {"preset": "Full preset", "ensemble": "Ensemble"})

    def test_nuisances_have_a_row_for_each_trial_after_those_of_the_same_seeds_without_any(self):
        self.writeTrials("trials.csv", range(6), 4, lambda seed, trial: seed < 2)
        self.writeTrials("nuisances/noise/trials.csv", range(4), 3, lambda seed, trial: trial == 2 and seed < 3,
                         lambda seed, trial: False)
        rows = efficient_tables.nuisance_rows(self.scratch, ["noise"])
        self.assertEqual([row[:4] for row in rows], [
            ("none", 100, 4, 0.5), ("none", 200, 4, 0.5), ("none", 300, 4, 0.5),
            ("noise", 100, 4, 0.0), ("noise", 200, 4, 0.0), ("noise", 300, 4, 0.75)])
        self.assertEqual(rows[5][6], 0.0)

    def test_nuisances_of_differing_frames_are_refused(self):
        self.writeTrials("nuisances/delay/trials.csv", range(4), 3, lambda seed, trial: True)
        self.writeTrials("nuisances/noise/trials.csv", range(4), 2, lambda seed, trial: True)
        with self.assertRaisesRegex(Failure, "nuisances/noise/trials.csv.* 300 .*delay.* 200"):
            efficient_tables.nuisance_rows(self.scratch, ["delay", "noise"])

    def test_a_nuisance_without_known_success_is_refused(self):
        self.writeLines("nuisances/noise/trials.csv", "seed,trial,frames,success,final_error", "0,0,100,,")
        with self.assertRaisesRegex(Failure, "nuisances/noise/trials.csv.*success"):
            efficient_tables.nuisance_rows(self.scratch, ["noise"])

    def test_gravity_has_the_rows_of_the_methods_that_were_run(self):
        self.writeTrials("gravity/trials.csv", range(2), 2, lambda seed, trial: trial == 1)
        self.writeTrials("gravity/oracle/trials.csv", range(2), 3, lambda seed, trial: True, frames=lambda trial: 0)
        rows = efficient_tables.gravity_rows(self.scratch)
        self.assertEqual([row[:4] for row in rows], [("ddm", 100, 2, 0.0), ("ddm", 200, 2, 1.0),
                                                     ("oracle", 0, 6, 1.0)])

    def targets(self):
        return {row[0]: row[2:] for row in efficient_tables.write_targets(self.scratch)}

    def writeHeadline(self, success, seeds=50, trials=16, strict=None):
        path = self.writeTrials("trials.csv", range(seeds), trials, success, strict)
        for seed in range(seeds):
            self.writeSeed(seed, 100.0 + 0.4 * seed)
        efficient_tables.write_success(self.scratch, self.file("sweep"))
        self.assertEqual(len(self.readTable("success_rate.csv")), trials)
        self.assertTrue(os.path.exists(path))

    def test_a_target_that_is_just_reached_holds(self):
        self.writeHeadline(lambda seed, trial: seed < 43 if trial == 0 else seed < (48 if trial < 5 else 50),
                           strict=lambda seed, trial: seed < 43 if trial == 0 else seed < (46 if trial < 5 else 49))
        targets = self.targets()
        self.assertEqual(targets["success, 100 frames"], ("0.86 [0.74, 0.93] of 50", "yes"))
        self.assertEqual(targets["mean success, 200 to 1600 frames"], ("0.989", "no"))  # (4 0.96 + 11) / 15
        self.assertEqual(targets["lowest success, 200 to 1600 frames"][1], "yes")
        self.assertEqual(targets["success minus success_strict, largest"], ("0.04 at 200 frames", "yes"))
        self.assertEqual(targets["whole experiment, largest of 50 seeds"], ("119.6 s", "yes"))
        self.assertEqual(targets["plan, 99 % of a greedy run, largest"], ("58.5 ms", "no"))

    def test_a_headline_below_the_targets_does_not_reach_them(self):
        self.writeHeadline(lambda seed, trial: seed < (42 if trial == 0 else 47 if trial == 3 else 50),
                           strict=lambda seed, trial: seed < 42)
        targets = self.targets()
        self.assertEqual([targets[point][1] for point in (
            "success, 100 frames", "mean success, 200 to 1600 frames", "lowest success, 200 to 1600 frames",
            "success minus success_strict, largest")], ["no", "yes", "no", "no"])
        self.assertIn("at 400 frames", targets["lowest success, 200 to 1600 frames"][0])

    def test_few_seeds_or_missing_points_have_no_verdict(self):
        self.writeHeadline(lambda seed, trial: True, seeds=49)
        self.assertEqual({row[1] for row in self.targets().values()}, {"n/a"})
        self.writeHeadline(lambda seed, trial: True, trials=15)
        targets = self.targets()
        self.assertEqual((targets["success, 100 frames"][1], targets["mean success, 200 to 1600 frames"][1]), ("yes", "n/a"))

    def test_gravity_is_judged_from_1500_to_2000_frames_by_what_learns_from_images(self):
        self.writeTrials("gravity/trials.csv", range(20), 20,
                         lambda seed, trial: trial >= 14 and seed < (20 if trial > 14 else 18))
        self.writeTrials("gravity/pilco_state/trials.csv", range(4), 20, lambda seed, trial: False)
        efficient_tables.write_gravity(self.scratch)
        targets = self.targets()
        self.assertEqual(targets["mean success with gravity, 1500 to 2000 frames"], ("0.983", "yes"))
        self.assertEqual(targets["lowest success with gravity, 1500 to 2000 frames"][1], "yes")
        self.writeTrials("gravity/trials.csv", range(20), 20, lambda seed, trial: trial >= 15 or seed < 15)
        efficient_tables.write_gravity(self.scratch)
        targets = self.targets()
        self.assertEqual(targets["mean success with gravity, 1500 to 2000 frames"], ("0.958", "no"))
        self.assertEqual(targets["lowest success with gravity, 1500 to 2000 frames"],
                         ("0.75 [0.53, 0.89] of 20 at 1500 frames", "no"))

    def test_the_mean_of_the_nuisances_is_judged_and_their_absence_is_not(self):
        self.writeTrials("trials.csv", range(20), 5, lambda seed, trial: False)
        self.writeTrials("nuisances/drops/trials.csv", range(20), 5, lambda seed, trial: trial > 0 or seed < 18)
        self.writeTrials("nuisances/delay/trials.csv", range(20), 5, lambda seed, trial: seed < (18 if trial else 16))
        efficient_tables.write_nuisances(self.scratch, ["delay", "drops"])
        self.assertEqual({point: holds for point, (_, holds) in self.targets().items()}, {
            "mean success of the nuisances, 100 frames": "yes", "mean success of the nuisances, 200 to 500 frames": "no"})
        self.assertEqual([row["holds"] for row in self.readTable("targets.csv")], ["yes", "no"])
