# reproduce_efficient with the programs themselves, in the debug preset; and whether they accept each variant.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_study.reproduce_efficient import TASKS, VARIANTS, yaml_names
from processes import call, find_program, run_experiment
from run_files import COLUMNS, read_rows, read_yaml
from scratch_case import ScratchCase


class ReproduceEfficientTest(ScratchCase):
    def assertAccepts(self, *arguments):
        code, output = run_experiment(*arguments, "--out", os.devnull)
        self.assertEqual(code, 1, "%s: %s" % (arguments, output))  # 2: it refuses its options
        self.assertIn(os.devnull, output)

    def test_run_experiment_accepts_each_variant_of_the_preset(self):
        for path in [path for part in VARIANTS.values() for path in yaml_names(part).values()]:
            self.assertAccepts("--preset", "efficient", "--config", path)

    def test_run_experiment_accepts_the_preset_for_gravity_with_each_method_and_for_each_task(self):
        for method in ("ddm", "oracle"):
            self.assertAccepts("--preset", "efficient", "--plant", "pendulum_gravity", "--method", method)
        for task in TASKS.values():
            self.assertAccepts("--preset", "efficient", "--plant", task.plant,
                               *(["--nuisance", task.nuisance] if task.nuisance else []))

    def test_headline_and_ablation_come_to_tables_and_figures(self):
        code, output = call([find_program("reproduce_efficient"), "--preset", "debug", "--seeds",
                             "100:102", "--ablation-seeds", "0:2", "--only", "efficient", "ablation", "--out",
                             self.out], 200.0)
        self.assertEqual(code, 0, output)
        rows = read_rows(self.out, "trials.csv")
        self.assertEqual(rows[0], COLUMNS)
        self.assertEqual([row[:2] for row in rows[1:]], [[str(s), str(t)] for s in (100, 101) for t in range(16)])
        self.assertEqual(len(read_rows(self.out, "success_rate.csv")), 17)
        for row in read_rows(self.out, "times.csv")[1:]:
            self.assertGreater(float(row[2]), float(row[1]) * 0.99, row)  # wall time: training and more
        variants = ["preset"] + list(yaml_names("ablations"))
        for name in variants:
            self.assertEqual(len(read_rows(self.out, "ablation", name, "trials.csv")), 1 + 2 * 4, name)
        self.assertEqual([row[0] for row in read_rows(self.out, "ablation.csv")[1:]],
                         [name for name in variants for _ in range(6)])
        self.assertEqual(sorted(read_yaml(self.out, "machine.yaml")["steps"]),
                         sorted(["efficient"] + ["ablation_" + name for name in variants]))
        for name in ("success_rate", "ablation"):
            self.assertGreater(os.path.getsize(os.path.join(self.out, name + ".png")), 1000)
        self.assertIn("config/ablations/residual.yaml", output)
        self.assertNotIn("config/ablations/auto_encoder_widths.yaml", output)
