# evaluate on a plant of a model file: the same rows however many runs there are at a time.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import call, find_program, needs_mujoco, run_experiment
from run_files import read_rows, read_yaml
from scratch_case import SharedScratchCase

SEEDS = 6
PLANT = ["--preset", "debug", "--plant", "suite_reacher_hard"]  # draws goals and has a reward
SHORT = "training: {num_starts: 1, max_iterations: 20}\nplant: {episode_frames: 200}\n"  # 40 images


@needs_mujoco
class EvaluateMujocoTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.config = os.path.join(cls.class_scratch, "short.yaml")
        with open(cls.config, "w") as stream:
            stream.write(SHORT)
        folder = os.path.join(cls.class_scratch, "run")
        code, output = run_experiment(*PLANT, "--config", cls.config, "--trials", "0", "--out", folder)
        assert code == 0, output
        cls.run_folder = folder
        cls.model = os.path.join(folder, "trial_000", "model.ddm")

    def evaluate(self, jobs):
        """Rows without the times of plans, and the summary."""
        folder = self.file("jobs_%d" % jobs)
        code, output = call([find_program("evaluate"), "--model", self.model, "--config", self.config,
                             "--seeds", "0:%d" % SEEDS, "--jobs", str(jobs), "--out", folder] + PLANT)
        self.assertEqual(code, 0, output)
        header, *lines = read_rows(folder, "evaluation.csv")
        rows = [dict(zip(header, line)) for line in lines]
        for row in rows:
            del row["plan_ms_median"], row["plan_ms_p99"]
        return rows, read_yaml(folder, "evaluation.yaml")

    def test_the_configuration_names_the_renderer_and_can_be_used_again(self):
        self.assertIn("llvmpipe", read_yaml(self.run_folder, "config.yaml")["renderer"])
        code, output = run_experiment("--config", os.path.join(self.run_folder, "config.yaml"), "--out",
                                      self.file("again"))
        self.assertEqual(code, 0, output)

    def test_jobs_change_nothing_but_the_time_it_takes(self):
        one = self.evaluate(1)
        self.assertEqual(len({row["final_error"] for row in one[0]}), SEEDS)  # torques differ, seed by seed
        self.assertTrue(all(0.0 <= float(row["return"]) <= 200.0 for row in one[0]), one)
        for jobs in (2, SEEDS):
            self.assertEqual(self.evaluate(jobs), one)
