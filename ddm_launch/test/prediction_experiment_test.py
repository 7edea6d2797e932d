# prediction_experiment and feature_space: their files, repeatability with a seed, and invalid inputs.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os

import numpy as np
import pytest

from processes import find_program, output_of, run_experiment
from run_files import files_in, read_bytes, read_rows, read_yaml

pytest.importorskip("ddm_sim")  # the Python bindings


def read_dicts(*path):
    with open(os.path.join(*path), newline="") as stream:
        return list(csv.DictReader(stream))


def predict(*arguments, seed=3, **expected):
    return output_of([find_program("prediction_experiment"), "--preset", "debug", "--plant", "moving_tile", "--seed", seed,
                      "--set", "training/num_starts=1", *arguments], **expected)


@pytest.fixture(name="reference", scope="module")
def make_reference(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("reference") / "tile")
    predict("--out", folder, words=["8 steps ahead"])
    return folder


def explained_by_a_quadratic_map(frames):
    """R^2 of the held-out positions for a quadratic map of the features, fitted to the training samples."""
    z1, z2, x, y = (np.array([float(frame[name]) for frame in frames]) for name in ("z_1", "z_2", "x_px", "y_px"))
    inputs = np.stack([np.ones_like(z1), z1, z2, z1 * z1, z1 * z2, z2 * z2], axis=1)
    positions = np.stack([x, y], axis=1)
    fit = np.linalg.lstsq(inputs[:501], positions[:501], rcond=None)[0]
    held_out = positions[501:]
    return 1.0 - np.sum((held_out - inputs[501:] @ fit) ** 2) / np.sum((held_out - held_out.mean(axis=0)) ** 2)


def test_the_files_have_a_row_for_each_number_of_steps_and_each_frame(reference):
    assert files_in(reference) == ["config.yaml", "features.csv", "model.ddm", "predictions.csv", "strip.csv",
                                   "summary.yaml"]
    summary = read_yaml(reference, "summary.yaml")
    assert [summary[key] for key in ("finished", "seed", "plant", "schedule")] == [True, 3, "moving_tile", "joint"]
    rows = read_dicts(reference, "predictions.csv")
    assert list(rows[0]) == ["seed", "steps", "num_predictions", "rmse", "rmse_repeat", "position_r2", "v_r", "v_p",
                             "train_s"]
    assert [row["steps"] for row in rows] == [str(k) for k in range(1, 9)]
    # 100 images, of which a prediction needs one before and eight after
    assert {row["num_predictions"] for row in rows} == {"91"}
    repeat = [float(row["rmse_repeat"]) for row in rows]
    assert repeat[:3] == sorted(repeat[:3])  # the tile moves away from its first position
    assert all(0.0 < float(row["rmse"]) < 1.0 for row in rows)
    frames = read_dicts(reference, "features.csv")
    assert list(frames[0]) == ["frame", "set", "x_px", "y_px", "z_1", "z_2"]
    assert [row["set"] for row in frames] == ["training"] * 501 + ["held_out"] * 100
    assert all(abs(float(after[name]) - float(before[name])) <= 5.0 + 1e-9  # the largest step of the tile
               for before, after in zip(frames, frames[1:]) for name in ("x_px", "y_px"))
    assert [float(row["position_r2"]) for row in rows] == pytest.approx([explained_by_a_quadratic_map(frames)] * 8)


def test_the_strip_begins_with_a_frame_and_its_feature_and_goes_on_with_predicted_ones(reference):
    strip = read_dicts(reference, "strip.csv")
    assert [row["steps"] for row in strip] == [str(k) for k in range(9)]
    features = {(row["x_px"], row["y_px"]): (row["z_1"], row["z_2"]) for row in read_dicts(reference, "features.csv")
                if row["set"] == "held_out"}
    equal = [features[row["x_px"], row["y_px"]] == (row["z_1"], row["z_2"]) for row in strip]
    assert equal[0] and not equal[8]


def test_same_seed_same_bytes_and_another_seed_other_frames(reference, tmp_path):
    again, other = str(tmp_path / "again"), str(tmp_path / "other")
    predict("--out", again)
    predict("--out", other, seed=4)
    for name in ("features.csv", "model.ddm", "strip.csv"):
        assert read_bytes(again, name) == read_bytes(reference, name)
        assert read_bytes(other, name) != read_bytes(reference, name)


@pytest.mark.parametrize("words", [["--set", "training/schedule=sequential"], ["--nuisance", "noise"]])
def test_schedules_and_nuisances_see_the_same_states_and_learn_other_models(words, reference, tmp_path):
    out = str(tmp_path / "out")
    predict(*words, "--out", out)
    assert [row[:4] for row in read_rows(out, "features.csv")] == [row[:4] for row in read_rows(reference, "features.csv")]
    assert read_bytes(out, "model.ddm") != read_bytes(reference, "model.ddm")


@pytest.mark.parametrize("words, parts", [
    (["--trials", "3", "--out", "x"], ["trials"]),
    (["--nuisance", "drops", "--out", "x"], ["camera/drop_rate", "got 0.05"]),
    (["--set", "image/size=25", "--out", "x"], ["image/size must be 51 ", "got 25"])])
def test_wrong_options_are_refused_with_code_2_and_make_no_folder(words, parts, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    predict(*words, code=2, words=parts)
    assert os.listdir(str(tmp_path)) == []


def test_the_folder_of_another_experiment_is_refused(reference):
    predict("--out", reference, seed=5, code=1, words=["experiment/seed: 3 there, 5 here"])


def test_feature_space_tells_experience_current_goal_and_plan_and_refuses_other_runs(tmp_path):
    run, out = str(tmp_path / "run"), str(tmp_path / "feature_space.csv")
    config = tmp_path / "nuisances.yaml"  # both programs see the same disturbed images
    config.write_text("camera: {noise_std: 0.1, brightness_drift: 0.2, clutter: 0.6, delay: 1, drop_rate: 0.1}\n")
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--config", str(config), "--out", run)

    def feature_space(*words, **expected):
        output_of([find_program("feature_space"), run, *words, "--out", out], **expected)

    feature_space("--trial", 1, "--step", 2)
    rows = read_rows(out)
    assert rows[0] == ["kind", "step", "z_1", "z_2"]
    kinds = ["experience"] * 60 + ["current", "goal"] + ["plan"] * 5  # two trials of 30 samples, K = 5
    assert [row[0] for row in rows[1:]] == kinds
    assert [row[1] for row in rows[-5:]] == ["3", "4", "5", "6", "7"]
    for words, code, part in ((("--trial", 1, "--step", 30), 1, "30 steps"), (("--trial", 1), 2, "--step"),
                              (("--trial", 7, "--step", 2), 1, "trial_007/model.ddm")):
        feature_space(*words, code=code, words=[part])
    torques = tmp_path / "run" / "evaluation_001" / "torques.csv"
    lines = torques.read_text().splitlines()
    torques.write_text("\n".join([lines[0], "0,1.25,0"] + lines[2:]) + "\n")
    feature_space("--trial", 1, "--step", 2, code=1, words=["torques.csv: ", "step 0 "])
