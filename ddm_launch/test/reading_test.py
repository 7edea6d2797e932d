# Programs that read a finished experiment do not change any byte of it.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import find_program, output_of, roslaunch, run_experiment
from run_files import changes
from sweeps import snapshot

LIMIT_S = 240.0  # time limit of a program on a busy machine


def test_what_reads_a_run_leaves_it_as_it_is(tmp_path):
    run, config = str(tmp_path / "run"), str(tmp_path / "run" / "config.yaml")
    run_experiment("--preset", "debug", "--trials", 1, "--set", "training/max_iterations=20", "--out", run)
    model = os.path.join(run, "trial_001", "model.ddm")
    bags = [os.path.join(run, "trial_%03d" % k, "trial.bag") for k in (0, 1)]
    before = snapshot(run)
    for package, *words in (
            ("ddm_launch", "evaluate", "--model", model, "--plant", "pendulum", "--seeds", "0:2", "--preset", "debug",
             "--config", config, "--out", "evaluated"),
            ("ddm_launch", "feature_space", run, "--trial", 1, "--step", 20, "--out", "space.csv"),
            ("ddm_launch", "figure", "film_strip", run), ("ddm_launch", "figure", "learning_curve", run),
            ("ddm_model", "export", "--model", model, "--out", "model.npz"),
            ("ddm_model", "inspect", "--model", model, "--out", "report", *bags),
            ("ddm_model", "train_from_bags", "--config", config, "--out", "again.ddm", *bags)):
        output_of([find_program(words[0], package)] + words[1:], LIMIT_S, folder=str(tmp_path))
        assert changes(before, snapshot(run)) == [], words
    for launch in (["control.launch", "num_steps:=5", "model:=" + model],
                   ["replay.launch", "model:=" + model, "bag:=" + bags[0], "rate:=0", "out:=%s/replay.csv" % tmp_path]):
        output = roslaunch(str(tmp_path), *launch, "preset:=debug", limit_s=LIMIT_S)
        assert changes(before, snapshot(run)) == [], output
        assert "process has finished cleanly" in output and "exit code" not in output
