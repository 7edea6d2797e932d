# prediction_experiment and feature_space: their files, what a seed fixes, what they refuse.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os

import pytest

from processes import call, find_program, run_experiment
from run_files import files_in, read_bytes, read_rows, read_yaml

QUICK = "training: {max_iterations: 20, num_starts: 1}\nprediction: {training_frames: 60, held_out_frames: 30}\n"


def read_dicts(*path):
    with open(os.path.join(*path), newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(name="quick", scope="module")
def write_quick(tmp_path_factory):
    path = tmp_path_factory.mktemp("quick") / "quick.yaml"
    path.write_text(QUICK)
    return str(path)


@pytest.fixture(name="predict", scope="module")
def make_predict(quick):
    def predict(*arguments, plant="moving_tile", seed=3):
        """(exit code, output)"""
        return call([find_program("prediction_experiment"), "--preset", "debug", "--plant", plant, "--seed", seed,
                     "--config", quick] + list(arguments))
    return predict


@pytest.fixture(name="reference", scope="module")
def make_reference(predict, tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("reference") / "tile")
    code, output = predict("--out", folder)
    assert code == 0 and "8 steps ahead" in output, output
    return folder


def test_the_files_have_a_row_for_each_number_of_steps_and_each_frame(reference):
    assert files_in(reference) == ["config.yaml", "features.csv", "model.ddm", "predictions.csv", "strip.csv",
                                   "summary.yaml"]
    summary = read_yaml(reference, "summary.yaml")
    assert [summary[key] for key in ("finished", "seed", "plant", "schedule")] == [True, 3, "moving_tile", "joint"]
    rows = read_dicts(reference, "predictions.csv")
    assert list(rows[0]) == ["seed", "steps", "num_predictions", "rmse", "rmse_repeat", "position_r2", "v_r", "v_p",
                             "train_s"]
    assert [row["steps"] for row in rows] == [str(k) for k in range(1, 9)]
    assert {row["num_predictions"] for row in rows} == {"21"}  # 30 frames, one before, eight after
    repeat = [float(row["rmse_repeat"]) for row in rows]
    assert repeat[:3] == sorted(repeat[:3])  # the tile moves away from where it was
    assert all(0.0 < float(row["rmse"]) < 1.0 for row in rows)
    frames = read_dicts(reference, "features.csv")
    assert list(frames[0]) == ["frame", "set", "x_px", "y_px", "z_1", "z_2"]
    assert [row["set"] for row in frames] == ["training"] * 60 + ["held_out"] * 30
    assert all(abs(float(after[name]) - float(before[name])) <= 5.0 + 1e-9  # as it is pushed
               for before, after in zip(frames, frames[1:]) for name in ("x_px", "y_px"))


def test_the_strip_begins_with_a_frame_and_its_feature_and_goes_on_with_predicted_ones(reference):
    strip = read_dicts(reference, "strip.csv")
    assert [row["steps"] for row in strip] == [str(k) for k in range(9)]
    features = {(row["x_px"], row["y_px"]): (row["z_1"], row["z_2"]) for row in read_dicts(reference, "features.csv")
                if row["set"] == "held_out"}
    equal = [features[row["x_px"], row["y_px"]] == (row["z_1"], row["z_2"]) for row in strip]
    assert equal[0] and not equal[8]


def test_same_seed_same_bytes_and_another_seed_other_frames(predict, reference, tmp_path):
    again, other = str(tmp_path / "again"), str(tmp_path / "other")
    assert predict("--out", again)[0] == predict("--out", other, seed=4)[0] == 0
    for name in ("features.csv", "model.ddm", "strip.csv"):
        assert read_bytes(again, name) == read_bytes(reference, name)
        assert read_bytes(other, name) != read_bytes(reference, name)


@pytest.mark.parametrize("words", [["--set", "training/schedule=sequential"], ["--nuisance", "noise"],
                                   ["--set", "image/size=25"]])
def test_schedules_nuisances_and_image_sizes_see_the_same_states_and_learn_other_models(words, predict, reference, tmp_path):
    out = str(tmp_path / "out")
    code, output = predict(*words, "--out", out)
    assert code == 0, output
    assert [row[:4] for row in read_rows(out, "features.csv")] == [row[:4] for row in read_rows(reference, "features.csv")]
    assert read_bytes(out, "model.ddm") != read_bytes(reference, "model.ddm")


def test_predicts_the_pendulum_from_the_fewest_frames_that_can_be_predicted(predict, tmp_path):
    out = str(tmp_path / "out")
    code, output = predict("--set", "prediction/held_out_frames=10", "--set", "prediction/training_frames=11", "--out", out,
                           plant="pendulum")
    assert code == 0, output
    assert read_rows(out, "features.csv")[0] == ["frame", "set", "angle_rad", "rate_rad_per_s", "z_1", "z_2"]
    assert {row["num_predictions"] for row in read_dicts(out, "predictions.csv")} == {"1"}


@pytest.mark.parametrize("words, parts", [
    (["--trials", "3", "--out", "x"], ["trials"]),
    (["--nuisance", "drops", "--out", "x"], ["camera/drop_rate", "got 0.05"]),
    (["--set", "prediction/held_out_frames=0", "--set", "prediction/max_stps=3", "--out", "x"],
     ["prediction/held_out_frames", "max_steps?"]),
    (["--set", "prediction/held_out_frames=9", "--set", "prediction/training_frames=10", "--set", "experiment/method=oracle",
      "--out", "x"],
     ["prediction/max_steps + model/order", "= 10", "got 9", "prediction/training_frames", "experiment/method"])])
def test_wrong_options_are_refused_with_code_2_and_make_no_folder(words, parts, predict, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, output = predict(*words)
    assert code == 2 and all(part in output for part in parts), output
    assert os.listdir(str(tmp_path)) == []


def test_the_folder_of_another_experiment_is_refused(predict, reference):
    code, output = predict("--out", reference, seed=5)
    assert code == 1 and "experiment/seed: 3 there, 5 here" in output


def test_feature_space_tells_experience_current_goal_and_plan_and_refuses_other_runs(tmp_path):
    run, out = str(tmp_path / "run"), str(tmp_path / "feature_space.csv")
    config = tmp_path / "nuisances.yaml"  # it sees what the camera of the run saw
    config.write_text("camera: {noise_std: 0.1, brightness_drift: 0.2, clutter: 0.6, delay: 1, drop_rate: 0.1}\n")
    code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--config", str(config), "--out", run)
    assert code == 0, output

    def feature_space(*words):
        return call([find_program("feature_space"), run, *words, "--out", out])

    code, output = feature_space("--trial", 1, "--step", 2)
    assert code == 0, output
    rows = read_rows(out)
    assert rows[0] == ["kind", "step", "z_1", "z_2"]
    kinds = ["experience"] * 60 + ["current", "goal"] + ["plan"] * 5  # two trials of 30, K = 5
    assert [row[0] for row in rows[1:]] == kinds
    assert [row[1] for row in rows[-5:]] == ["3", "4", "5", "6", "7"]
    for words, code, part in ((("--trial", 1, "--step", 30), 1, "30 steps"), (("--trial", 1), 2, "--step"),
                              (("--trial", 7, "--step", 2), 1, "trial_007/model.ddm")):
        found, output = feature_space(*words)
        assert found == code and part in output
    torques = tmp_path / "run" / "evaluation_001" / "torques.csv"
    lines = torques.read_text().splitlines()
    torques.write_text("\n".join([lines[0], "0,1.25,0"] + lines[2:]) + "\n")
    code, output = feature_space("--trial", 1, "--step", 2)
    assert code == 1 and "torques.csv: " in output and "step 0 " in output
