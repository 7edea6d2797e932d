# reproduce_paper: the whole path in the debug preset, interrupted once, then to its end.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal

from processes import Process, call, find_program
from run_files import COLUMNS, read_bytes, read_rows, read_yaml
from scratch_case import ScratchCase

FIGURES = ["angle_trajectories", "feature_plane", "pendulum_feature_space", "prediction_strip", "schedules_compared",
           "success_rate", "trajectory_distributions"]
PILCO = {"pilco_state": (2, 10), "pilco_state_sparse": (2, 10), "pilco_features": (2, 16), "pilco_pca": (1, 6)}
SCHEDULES = ["sequential", "v_p_only", "joint_random_init"]


def png_size(path):
    """(width, height) of a PNG file [pixels]."""
    head = read_bytes(path)[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n", path
    return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")


class ReproducePaperTest(ScratchCase):
    def setUp(self):
        super().setUp()
        # PILCO's time grows with the cube of the frames
        self.small = self.write("small.yaml", "trial: {num_steps: 30}\ngp: {max_iterations: 5}\n"
                                "sparse_gp: {max_points: 50, first_iterations: 2, max_iterations: 2}\n")

    def path(self, *names):
        return os.path.join(self.out, *names)

    def command(self):
        return [find_program("reproduce_paper"), "--preset", "debug", "--seeds", 2, "--out", self.out,
                "--config", self.small]

    def test_goes_on_after_an_interruption_and_leaves_tables_and_figures(self):
        process = Process(self.command())
        process.waitForText("joint  ", 60.0)  # the first sweep is over
        process.send(signal.SIGINT)
        self.assertEqual(process.waitForEnd(30.0), 130, process.output)
        first = read_bytes(self.path("runs", "joint", "seed_0000", "trials.csv"))
        self.assertFalse(os.path.exists(self.path("agreement.csv")))

        code, output = call(self.command(), 240.0)
        self.assertEqual(code, 0, output)
        self.assertEqual(read_bytes(self.path("runs", "joint", "seed_0000", "trials.csv")), first)  # not run again

        rows = read_rows(self.path("trials.csv"))
        self.assertEqual(rows[0], COLUMNS)
        self.assertEqual([row[:2] for row in rows[1:]], [[str(s), str(t)] for s in range(2) for t in range(16)])
        for name in ["oracle"] + SCHEDULES:
            self.assertEqual(len(read_rows(self.path(name, "trials.csv"))), 33, name)
        self.assertEqual([row[:2] for row in read_rows(self.path("bfgs", "trials.csv"))[1:]],
                         [[str(s), str(t)] for s in range(2) for t in range(5)])
        self.assertEqual([row[0] for row in read_rows(self.path("solvers.csv"))[1:]], 5 * ["lbfgs"] + 5 * ["bfgs"])
        for name in ["joint"] + SCHEDULES:
            for plant in ("tile_predictions", "pendulum_predictions"):
                self.assertEqual(len(read_rows(self.path(plant, name, "predictions.csv"))), 17, (plant, name))
        self.assertEqual({row[3] for row in read_rows(self.path("oracle", "trials.csv"))[1:]}, {"1"})

        for name, (seeds, trials) in PILCO.items():
            for table in ("trials.csv", "policy_search.csv"):
                self.assertEqual([row[:2] for row in read_rows(self.path(name, table))[1:]],
                                 [[str(s), str(t)] for s in range(seeds) for t in range(trials)], (name, table))
        self.assertEqual([row[1] for row in read_rows(self.path("pilco.csv")) if row[0] == "pilco_pca"],
                         ["1", "2", "3", "4", "5", "6", "2 to 6"])
        kinds = [row[3] for row in read_rows(self.path("trajectory_distributions.csv"))[1:] if row[4] == "1"]
        self.assertEqual(kinds, 2 * 6 * ["predicted", "evaluation", "trial"])

        for name in FIGURES:
            width, height = png_size(self.path(name + ".png"))
            self.assertTrue(600 <= width <= 1500 and 200 <= height <= 1500, (name, width, height))
        holds = {row[0]: row[3] for row in read_rows(self.path("agreement.csv"))[1:]}
        self.assertEqual(holds["oracle: success of the same planner with a perfect model"], "yes")
        self.assertTrue(set(holds.values()) <= {"yes", "no", "n/a"})
        for point, _, _, verdict in read_rows(self.path("agreement.csv"))[1:]:
            self.assertIn("%-3s  %s" % (verdict, point), output)

        machine = read_yaml(self.path("machine.yaml"))
        self.assertEqual(machine["preset"], "debug")
        self.assertEqual(len(machine["steps"]), 19)
        self.assertEqual({name: step["seeds_run"] for name, step in machine["steps"].items() if step["seeds_run"] != 2},
                         {"pilco_pca": 1})
        for name, step in machine["steps"].items():
            self.assertGreater(step["wall_s"], 0.0, name)
            self.assertTrue(20.0 < step["peak_memory_mb"] < 500.0, (name, step))

    def test_a_folder_of_another_preset_is_refused_with_the_place_to_look(self):
        os.makedirs(self.path("runs", "joint"))
        with open(self.path("runs", "joint", "sweep.yaml"), "w") as stream:
            stream.write("program: run_experiment\npreset: paper\nplant: pendulum\noptions: []\n")
        code, output = call(self.command())
        self.assertEqual(code, 1)
        self.assertIn("logs/joint.log", output)
        self.assertIn("preset: paper", read_bytes(self.path("logs", "joint.log")).decode())

    def test_results_of_pilco_are_not_mixed_with_tables_without_it(self):
        os.makedirs(self.out)
        open(self.path("pilco.csv"), "w").close()
        code, output = call(self.command() + ["--without-pilco"])
        self.assertEqual(code, 1)
        self.assertIn("--without-pilco", output)
        self.assertEqual(os.listdir(self.path("runs")) if os.path.exists(self.path("runs")) else [], [])

    def test_wrong_options_end_with_code_2(self):
        for arguments in (["--seeds", "0"], ["--seeds", "0:5"], ["--figures"]):
            code, output = call([find_program("reproduce_paper"), "--out", self.out] + arguments)
            self.assertEqual(code, 2, output)
        self.assertFalse(os.path.exists(self.out))
