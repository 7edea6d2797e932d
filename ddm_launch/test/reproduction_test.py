# The steps of reproduce_paper, and what it keeps of PILCO's run folders: without running anything.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

from ddm_study import reproduce_paper
from run_files import read_bytes, read_rows
from scratch_case import ScratchCase
import synthetic_run

PILCO = ["pilco_state", "pilco_state_sparse", "pilco_features", "pilco_pca"]


class ReproductionTest(ScratchCase):
    def reproduction(self, seeds=50, without_pilco=False, config=()):
        return reproduce_paper.Reproduction(argparse.Namespace(out=self.out, preset="paper", seeds=seeds, jobs=None,
                                                               without_pilco=without_pilco, config=list(config)))

    def words(self, reproduction, name):
        """The command of a step, from its options on."""
        return reproduction.by_name[name].command(self.out, None)[1:]

    def test_pilco_comes_last_and_can_be_left_out(self):
        names = [step.name for step in self.reproduction().steps]
        self.assertEqual(names[-4:], PILCO)
        self.assertEqual([step.name for step in self.reproduction(without_pilco=True).steps], names[:-4])

    def test_each_step_of_pilco_has_its_method_seeds_and_trials(self):
        for seeds, expected in ((50, ["0:12", "0:2", "0:5", "0:1"]), (3, ["0:3", "0:2", "0:3", "0:1"])):
            reproduction = self.reproduction(seeds)
            commands = [self.words(reproduction, name) for name in PILCO]
            self.assertEqual([words[words.index("--seeds") + 1] for words in commands], expected)
            self.assertEqual([words[words.index("--trials") + 1] for words in commands], ["9", "9", "15", "5"])
            self.assertEqual([words[words.index("--method") + 1] for words in commands],
                             ["pilco_state", "pilco_state", "pilco_features", "pilco_pca"])
            for words in commands:
                self.assertLess(words.index("--"), words.index("--method"))  # sweep itself has no such option

    def test_only_the_sparse_step_has_a_configuration_of_its_own_and_the_file_is_there(self):
        for name in PILCO:
            words = self.words(self.reproduction(), name)
            self.assertEqual("--config" in words, name == "pilco_state_sparse")
        path = self.words(self.reproduction(), "pilco_state_sparse")[-1]
        self.assertEqual(os.path.basename(path), "sparse_gp.yaml")
        self.assertTrue(os.path.isfile(path), path)

    def test_a_configuration_of_the_user_comes_last_in_every_step(self):
        reproduction = self.reproduction(config=["/a.yaml", "/b.yaml"])
        for step in reproduction.steps:
            self.assertEqual(self.words(reproduction, step.name)[-4:], ["--config", "/a.yaml", "--config", "/b.yaml"])
            self.assertIn("--", self.words(reproduction, step.name))

    def test_figures_show_pilco_only_where_it_is_run(self):
        figures = self.reproduction().figure_commands()
        self.assertEqual([word.split("=")[0] for word in figures["success_rate"] if word.endswith("trials.csv")],
                         ["DDM + MPC", "PILCO, state", "PILCO, features", "PILCO, PCA", "oracle"])
        self.assertIn(os.path.join(self.out, "trajectory_distributions.csv"), figures["trajectory_distributions"])
        figures = self.reproduction(without_pilco=True).figure_commands()
        self.assertNotIn("PILCO", " ".join(figures["success_rate"]))
        self.assertNotIn("trajectory_distributions", figures)

    def test_searches_configurations_and_distributions_are_kept(self):
        reproduction = self.reproduction(seeds=4)
        for step in reproduction.pilco:
            for seed, folder in step.seed_folders(self.out).items():
                synthetic_run.write_pilco_run(folder, seed, num_trials=5)
        reproduction.collect_pilco()
        for name, seeds in zip(PILCO, (4, 2, 4, 1)):
            rows = read_rows(self.out, name, "policy_search.csv")
            self.assertEqual(rows[0][:5], ["seed", "trial", "frames", "gp_s", "policy_search_s"])
            self.assertEqual([row[:2] for row in rows[1:]], [[str(seed), str(k)] for seed in range(seeds)
                                                             for k in range(5)])
            self.assertEqual(read_bytes(self.out, name, "config.yaml"),
                             read_bytes(self.out, "runs", name, "seed_0000", "config.yaml"))
        rows = read_rows(self.out, "trajectory_distributions.csv")
        self.assertEqual(rows[0], "seed,trial,frames,kind,step,time_s,angle_rad,angle_std_rad".split(","))
        panels = sorted({(row[0], row[2]) for row in rows[1:]}, key=lambda panel: (panel[0], int(panel[1])))
        self.assertEqual(panels, [(seed, frames) for seed in "012" for frames in ("125", "250", "375", "500")])
        self.assertEqual(rows[2], ["0", "0", "125", "predicted", "1", "0.200", "1.0000", "0.2500"])
