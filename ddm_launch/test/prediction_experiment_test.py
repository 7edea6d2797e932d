# prediction_experiment and feature_space: their files, what a seed fixes, what they refuse.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import math
import os

from processes import call, find_program, run_experiment
from run_files import files_in, read_bytes, read_rows, read_yaml
from scratch_case import SharedScratchCase

FILES = ["config.yaml", "features.csv", "model.ddm", "predictions.csv", "strip.csv", "summary.yaml"]
QUICK = "training: {max_iterations: 20, num_starts: 1}\nprediction: {training_frames: 60, held_out_frames: 30}\n"


def read_dicts(*path):
    with open(os.path.join(*path), newline="") as stream:
        return list(csv.DictReader(stream))


class PredictionExperimentTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.quick = os.path.join(cls.class_scratch, "quick.yaml")
        with open(cls.quick, "w") as stream:
            stream.write(QUICK)
        cls.reference = os.path.join(cls.class_scratch, "reference")
        cls.code, cls.output = cls.predict("--out", cls.reference)

    @classmethod
    def predict(cls, *arguments, plant="moving_tile", seed=3):
        return call([find_program("prediction_experiment"), "--preset", "debug", "--plant", plant,
                     "--seed", seed, "--config", cls.quick] + list(arguments))

    def test_leaves_these_files_and_says_how_it_went(self):
        self.assertEqual(self.code, 0, self.output)
        self.assertEqual(files_in(self.reference), FILES)
        summary = read_yaml(self.reference, "summary.yaml")
        self.assertIs(summary["finished"], True)
        self.assertEqual((summary["seed"], summary["plant"], summary["schedule"]), (3, "moving_tile", "joint"))
        self.assertIn("8 steps ahead", self.output)

    def test_predictions_hold_a_row_for_each_number_of_steps(self):
        rows = read_dicts(self.reference, "predictions.csv")
        self.assertEqual(list(rows[0]), ["seed", "steps", "num_predictions", "rmse", "rmse_repeat", "position_r2",
                                         "v_r", "v_p", "train_s"])
        self.assertEqual([row["steps"] for row in rows], [str(k) for k in range(1, 9)])
        self.assertEqual({row["num_predictions"] for row in rows}, {"21"})  # 30 frames, one before, eight after
        repeat = [float(row["rmse_repeat"]) for row in rows]
        self.assertEqual(repeat[:3], sorted(repeat[:3]))  # the tile moves away from where it was
        self.assertTrue(all(0.0 < float(row["rmse"]) < 1.0 for row in rows))

    def test_features_hold_every_frame_and_the_tile_moves_as_it_is_pushed(self):
        rows = read_dicts(self.reference, "features.csv")
        self.assertEqual(list(rows[0]), ["frame", "set", "x_px", "y_px", "z_1", "z_2"])
        self.assertEqual([row["set"] for row in rows], ["training"] * 60 + ["held_out"] * 30)
        for before, after in zip(rows, rows[1:]):
            for name in ("x_px", "y_px"):
                self.assertLessEqual(abs(float(after[name]) - float(before[name])), 5.0 + 1e-9)
            self.assertLessEqual(abs(float(after["z_1"])), math.pi / 2)

    def test_the_strip_begins_with_a_frame_and_its_feature(self):
        strip = read_dicts(self.reference, "strip.csv")
        self.assertEqual([row["steps"] for row in strip], [str(k) for k in range(9)])
        frames = {(row["x_px"], row["y_px"]): row for row in read_dicts(self.reference, "features.csv")
                  if row["set"] == "held_out"}
        for row in strip:  # all true states are held-out frames
            self.assertIn((row["x_px"], row["y_px"]), frames)
        first = frames[strip[0]["x_px"], strip[0]["y_px"]]
        self.assertEqual((strip[0]["z_1"], strip[0]["z_2"]), (first["z_1"], first["z_2"]))
        last = frames[strip[8]["x_px"], strip[8]["y_px"]]
        self.assertNotEqual((strip[8]["z_1"], strip[8]["z_2"]), (last["z_1"], last["z_2"]))  # predicted, not seen

    def test_same_seed_same_bytes_and_another_seed_other_frames(self):
        again, other = self.file("again"), self.file("other")
        self.assertEqual(self.predict("--out", again)[0], 0)
        self.assertEqual(self.predict("--out", other, seed=4)[0], 0)
        for name in ("features.csv", "model.ddm", "strip.csv"):
            self.assertEqual(read_bytes(again, name), read_bytes(self.reference, name), name)
            self.assertNotEqual(read_bytes(other, name), read_bytes(self.reference, name), name)

    def test_schedules_see_the_same_frames_and_learn_other_models(self):
        config = self.write("sequential.yaml", "training: {schedule: sequential}\n")
        code, output = self.predict("--config", config, "--out", self.out)
        self.assertEqual(code, 0, output)

        def states(folder):
            return [row[:4] for row in read_rows(folder, "features.csv")]

        self.assertEqual(states(self.out), states(self.reference))
        self.assertNotEqual(read_bytes(self.out, "model.ddm"), read_bytes(self.reference, "model.ddm"))
        self.assertEqual(read_yaml(self.out, "summary.yaml")["schedule"], "sequential")

    def test_predicts_the_pendulum_too(self):
        code, output = self.predict("--out", self.out, plant="pendulum")
        self.assertEqual(code, 0, output)
        self.assertEqual(read_rows(self.out, "features.csv")[0],
                         ["frame", "set", "angle_rad", "rate_rad_per_s", "z_1", "z_2"])

    def test_takes_nuisances_but_no_lost_frames(self):
        code, output = self.predict("--nuisance", "noise", "--out", self.out)
        self.assertEqual(code, 0, output)
        self.assertEqual(read_yaml(self.out, "config.yaml")["camera"]["noise_std"], 0.1)
        self.assertEqual([row[:4] for row in read_rows(self.out, "features.csv")],  # the same states, seen otherwise
                         [row[:4] for row in read_rows(self.reference, "features.csv")])
        self.assertNotEqual(read_bytes(self.out, "model.ddm"), read_bytes(self.reference, "model.ddm"))
        code, output = self.predict("--nuisance", "drops", "--out", self.file("drops"))
        self.assertEqual(code, 2)
        self.assertIn("camera/drop_rate", output)
        self.assertIn("got 0.05", output)

    def test_refuses_the_folder_of_another_experiment_and_leaves_it_as_it_is(self):
        before = {name: read_bytes(self.reference, name) for name in FILES}
        code, output = self.predict("--out", self.reference, seed=5)
        self.assertEqual(code, 1)
        self.assertIn("experiment/seed: 3 there, 5 here", output)
        self.assertEqual({name: read_bytes(self.reference, name) for name in FILES}, before)

    def test_refuses_wrong_options_with_code_2(self):
        for words, arguments in ((("'--out'",), ()), (("trials",), ("--out", "x", "--trials", "3"))):
            code, output = self.predict(*arguments)
            self.assertEqual(code, 2, output)
            for word in words:
                self.assertIn(word, output)
        config = self.write("wrong.yaml", "prediction: {held_out_frames: 0, max_stps: 3}\ntraining: {schedule: both}\n")
        code, output = self.predict("--config", config, "--out", self.out)
        self.assertEqual(code, 2)
        for word in ("prediction/held_out_frames", "max_stps", "max_steps?", "training/schedule",
                     "got both"):
            self.assertIn(word, output)
        self.write("wrong.yaml",
                   "prediction: {held_out_frames: 9, training_frames: 10}\nexperiment: {method: oracle}\n")
        code, output = self.predict("--config", config, "--out", self.out)
        self.assertEqual(code, 2)
        for word in ("prediction/max_steps + model/order", "= 10", "got 9", "prediction/training_frames", "got 10",
                     "experiment/method", "got oracle"):
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.out))

    def test_the_fewest_frames_that_can_be_predicted_are_predicted(self):
        config = self.write("few.yaml", "prediction: {held_out_frames: 10, training_frames: 11}\n")
        code, output = self.predict("--config", config, "--out", self.out)
        self.assertEqual(code, 0, output)
        self.assertEqual({row["num_predictions"] for row in read_dicts(self.out, "predictions.csv")}, {"1"})

    def test_images_of_another_size_than_the_cameras_are_learned_from(self):
        code, output = self.predict("--config", self.write("small.yaml", "image: {size: 25}\n"), "--out", self.out)
        self.assertEqual(code, 0, output)
        self.assertLess(os.path.getsize(os.path.join(self.out, "model.ddm")),
                        0.5 * os.path.getsize(os.path.join(self.reference, "model.ddm")))

    def test_feature_space_tells_experience_current_goal_and_plan(self):
        run, out = self.file("run"), self.file("feature_space.csv")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", run)
        self.assertEqual(code, 0, output)
        program = find_program("feature_space")
        code, output = call([program, run, "--trial", 1, "--step", 2, "--out", out])
        self.assertEqual(code, 0, output)
        rows = read_rows(out)
        self.assertEqual(rows[0], ["kind", "step", "z_1", "z_2"])
        kinds = [row[0] for row in rows[1:]]
        self.assertEqual(kinds, ["experience"] * 60 + ["current", "goal"] + ["plan"] * 5)  # two trials of 30, K = 5
        self.assertEqual([row[1] for row in rows[-5:]], ["3", "4", "5", "6", "7"])
        code, output = call([program, run, "--trial", 1, "--step", 30, "--out", out])
        self.assertEqual(code, 1)
        self.assertIn("30 steps", output)
        torques = os.path.join(run, "evaluation_001", "torques.csv")
        with open(torques) as stream:
            lines = stream.read().splitlines()
        with open(torques, "w") as stream:
            stream.write("\n".join([lines[0], "0,1.25,0"] + lines[2:]) + "\n")
        code, output = call([program, run, "--trial", 1, "--step", 2, "--out", out])
        self.assertEqual(code, 1)
        self.assertRegex(output, "torques.csv: .*step 0 ")
        code, output = call([program, run, "--trial", 7, "--step", 2, "--out", out])
        self.assertEqual(code, 1)
        self.assertIn("trial_007/model.ddm", output)
        code, output = call([program, run, "--trial", 1, "--out", out])
        self.assertEqual(code, 2)
        self.assertIn("--step", output)

    def test_feature_space_sees_what_the_camera_of_the_run_saw(self):
        run = self.file("run")
        config = self.write("nuisances.yaml", "camera: {noise_std: 0.1, brightness_drift: 0.2, clutter: 0.6, delay: 1, "
                                              "drop_rate: 0.2}\n")
        code, output = run_experiment("--preset", "debug", "--trials", 0, "--config", config, "--out", run)
        self.assertEqual(code, 0, output)
        code, output = call([find_program("feature_space"), run, "--trial", 0, "--step", 29,
                             "--out", self.out])
        self.assertEqual(code, 0, output)  # each torque up to there was the recorded one
