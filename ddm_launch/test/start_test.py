# Experiments that start from a model and bags: both drivers agree, they can be resumed, and invalid inputs are refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import pytest

from processes import find_program, has_mujoco, output_of, roslaunch, run_experiment
from run_files import differences, expected_files, files_in, read_rows, read_yaml

STEPS = 30
NAMES = [name for name in expected_files(1) if not name.endswith(".bag")]


class Before:
    """An experiment whose bags and last model are the start of others, with seed 2."""

    def __init__(self, folder):
        self.folder = os.path.join(folder, "before")
        run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", self.folder)
        self.model = os.path.join(self.folder, "trial_001", "model.ddm")
        self.bags = [os.path.join(self.folder, "trial_%03d" % k, "trial.bag") for k in range(2)]
        self.both = ["--model", self.model, "--bags", *self.bags]


@pytest.fixture(name="before", scope="module")
def make(tmp_path_factory):
    return Before(str(tmp_path_factory.mktemp("start")))


def start(out, *arguments, trials=1, **expected):
    return run_experiment("--preset", "debug", "--seed", 2, "--trials", trials, "--out", out, *arguments, **expected)


def evaluate(model, out, *arguments, **expected):
    return output_of([find_program("evaluate"), "--model", model, "--preset", "debug", "--out", out, *arguments], **expected)


def test_bags_count_as_trials_and_the_model_explores_in_trial_0_in_both_drivers_and_when_interrupted(before, tmp_path):
    out, nodes = str(tmp_path / "out"), str(tmp_path / "nodes")
    start(out, *before.both)
    assert files_in(out) == expected_files(1)
    assert [row[2] for row in read_rows(out, "trials.csv")[1:]] == [str(3 * STEPS), str(4 * STEPS)]
    assert {row[2] for row in read_rows(out, "trial_000", "torques.csv")[1:]} == {"0", "1"}
    saved = read_yaml(out, "config.yaml")["start"]
    assert (saved["model"], saved["bags"]) == (before.model, before.bags)
    output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "seed:=2", "trials:=1", "runs:=" + nodes,
                       "model:=before/trial_001/model.ddm", "bags:=before/trial_000/trial.bag " + before.bags[1],
                       folder=os.path.dirname(before.folder))
    assert os.path.exists(os.path.join(nodes, "summary.yaml")), output
    assert differences(nodes, out, NAMES) == []
    for trials in (0, 1):
        start(tmp_path / "interrupted", *before.both, trials=trials)
    assert differences(tmp_path / "interrupted", out, NAMES) == []


def test_the_saved_configuration_starts_the_same_and_notices_other_files(before, tmp_path):
    out, model, config = str(tmp_path / "out"), str(tmp_path / "model.ddm"), str(tmp_path / "config.yaml")
    shutil.copy(before.model, model)
    start(out, "--model", model, trials=0)
    shutil.copy(os.path.join(out, "config.yaml"), config)
    start(tmp_path / "again", "--config", config, trials=0)
    assert differences(tmp_path / "again", out, ["trial_000/torques.csv"]) == []
    shutil.copy(os.path.join(before.folder, "trial_000", "model.ddm"), model)
    for words, arguments in ((model + " has changed", ["--config", config]), ("start/checksums", ["--model", model]),
                             ("start/model: %s there, nothing here" % model, [])):
        assert words in start(out, *arguments, code=1)


def test_what_cannot_be_started_from_is_refused_and_leaves_no_folder(before, tmp_path):
    out, bag, tile = str(tmp_path / "out"), before.bags[0], ["--plant", "moving_tile"]
    for words, arguments in (
            (["bag " + bag, "the plant", "(dt): 0.2 ", ", 0.1 "], ["--set", "plant/dt=0.1", "--bags", bag]),
            (["bag " + bag, "images: 51x51 mono8 ", ", 40x40 mono8 "], ["--set", "plant/image_size=40", "--bags", bag]),
            (["bag " + bag, "torques", ": 1 ", ", 2 "], ["--bags", bag, *tile]),
            (["model " + before.model, "torques of 1", "plant 2"], ["--model", before.model, *tile]),
            (["size 51", "image/size is 40"], ["--set", "image/size=40", "--model", before.model]),
            (["missing.bag"], ["--bags", "missing.bag"]), ([bag, "DDMMODEL"], ["--model", bag]),
            (["given twice"], ["--bags", bag, bag]),
            (["method oracle", "only ddm"], ["--method", "oracle", "--model", before.model])):
        start(out, *arguments, code=1, words=words)
        assert not os.path.exists(out)


def test_evaluate_repeats_the_evaluation_of_the_experiment_however_many_run_at_a_time(before, tmp_path):
    tables = []
    for jobs in ("1", "3"):
        out = str(tmp_path / jobs)
        evaluate(before.model, out, "--seeds", "1:4", "--jobs", jobs)
        tables.append([row[:4] for row in read_rows(out, "evaluation.csv")])
    assert tables[0] == tables[1]
    header, *rows = tables[0]
    assert header == ["seed", "success", "success_strict", "final_error"]
    theirs = read_rows(before.folder, "trials.csv")[2]
    assert rows[0] == [theirs[0]] + theirs[3:6]
    assert [row[0] for row in rows] == ["1", "2", "3"] and len({row[3] for row in rows}) == 3
    summary = read_yaml(out, "evaluation.yaml")
    assert summary["success"] == "%d of 3" % sum(row[1] == "1" for row in rows)
    assert "success_interval_95" in summary


@pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo")
def test_parallel_evaluations_of_a_plant_of_a_model_file_change_nothing_and_the_configuration_names_the_renderer(tmp_path):
    plant = ["--plant", "suite_reacher_hard",  # this plant draws goals and has a reward
             "--set", "training/num_starts=1", "--set", "training/max_iterations=20", "--set", "plant/episode_frames=150"]
    run_experiment("--preset", "debug", *plant, "--trials", "0", "--out", tmp_path / "run")
    assert "llvmpipe" in read_yaml(tmp_path, "run", "config.yaml")["renderer"]
    tables = []
    for jobs in (1, 3):
        evaluate(tmp_path / "run" / "trial_000" / "model.ddm", tmp_path / str(jobs), "--seeds", "0:3", "--jobs", jobs, *plant)
        header, *rows = read_rows(tmp_path, str(jobs), "evaluation.csv")
        tables.append([{name: value for name, value in zip(header, row) if not name.startswith("plan_ms")} for row in rows])
    assert tables[0] == tables[1]
    assert len({row["final_error"] for row in tables[0]}) == 3  # each seed has other torques
    assert all(0.0 <= float(row["return"]) <= 150.0 for row in tables[0])


def test_evaluate_takes_the_model_s_own_shape_and_refuses_what_does_not_fit(before, tmp_path):
    model, out = str(tmp_path / "shape.ddm"), str(tmp_path / "out")
    (tmp_path / "shape.yaml").write_text("image: {size: 40}\nmodel: {predictor: gp, order: 3}\n")
    output_of([find_program("train_from_bags", "ddm_model"), "--config", tmp_path / "shape.yaml", "--out", model,
               *before.bags])
    output = evaluate(model, out, "--seeds", "0:2")
    assert len(read_rows(out, "evaluation.csv")) == 3, output
    for code, words, arguments in ((2, ["--seeds", "A:B", "got '3'"], ["--seeds", "3"]),
                                   (2, ["got '3:3'"], ["--seeds", "3:3"]),
                                   (2, ["--jobs", ">= 1", "got 0"], ["--seeds", "0:1", "--jobs", "0"]),
                                   (2, ["unknown plant 'robot'"], ["--seeds", "0:1", "--plant", "robot"]),
                                   (1, ["torques of 1", "plant 2"], ["--seeds", "0:1", "--plant", "moving_tile"])):
        evaluate(before.model, out, *arguments, code=code, words=words)
