# Reading never writes: a finished run keeps every byte, whatever reads it and whatever is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import pytest

from processes import call, find_program, roslaunch, run_experiment
from run_files import changes, fingerprint

LIMIT_S = 240.0  # of a program on a machine that has much else to do
QUICK = "training: {max_iterations: 20, num_starts: 1}\nprediction: {training_frames: 60, held_out_frames: 30}\n"


class Made:
    """A run of two models and a prediction, both finished."""

    def __init__(self, folder):
        self.config, self.run, self.prediction = (str(folder / name) for name in ("quick.yaml", "run", "prediction"))
        (folder / "quick.yaml").write_text(QUICK)
        for name, plant, words in (("run_experiment", "pendulum", ["--trials", 1, "--out", self.run]),
                                   ("prediction_experiment", "moving_tile", ["--out", self.prediction])):
            code, output = call([find_program(name), "--preset", "debug", "--plant", plant, "--seed", 1, "--config",
                                 self.config] + words)
            assert code == 0, output
        self.model = os.path.join(self.run, "trial_001", "model.ddm")
        self.bags = [os.path.join(self.run, "trial_%03d" % k, "trial.bag") for k in (0, 1)]
        self.before = self.fingerprint()

    def fingerprint(self):
        return dict(fingerprint(self.run), **fingerprint(self.prediction))

    def assert_unchanged(self, words):
        assert changes(self.before, self.fingerprint()) == [], words

    def experiment(self, out, seed=1, trials=1):
        return ["--preset", "debug", "--seed", seed, "--trials", trials, "--config", self.config, "--out", out]


@pytest.fixture(name="made", scope="module")
def make(tmp_path_factory):
    return Made(tmp_path_factory.mktemp("made"))


def assert_refused(word, folder, *words):
    """run_experiment fails, says the word, and leaves the folder as it is, or leaves none."""
    def now():
        return fingerprint(folder) if os.path.exists(folder) else {}
    before = now()
    code, output = run_experiment(*words)
    assert code != 0 and word in output, output
    assert changes(before, now()) == [], output


def test_programs_that_read_a_run_or_a_prediction_leave_it_as_it_is(made, tmp_path):
    config = os.path.join(made.run, "config.yaml")
    for package, *words in (
            ("ddm_launch", "evaluate", "--model", made.model, "--plant", "pendulum", "--seeds", "0:2", "--preset", "debug",
             "--config", config, "--out", "evaluated"),
            ("ddm_launch", "feature_space", made.run, "--trial", 1, "--step", 20, "--out", "space.csv"),
            ("ddm_launch", "figure", "film_strip", made.run),
            ("ddm_launch", "figure", "learning_curve", made.run),
            ("ddm_launch", "study", "figure", "pendulum_feature_space", "space.csv", "--model", made.model),
            ("ddm_launch", "study", "figure", "feature_plane", "joint=" + made.prediction),
            ("ddm_launch", "study", "figure", "prediction_strip", made.prediction),
            ("ddm_model", "export", "--model", made.model, "--out", "model.npz"),
            ("ddm_model", "inspect", "--model", made.model, "--out", "report", *made.bags),
            ("ddm_model", "read_bags", "--image-size", 51, "--out", "frames", *made.bags),
            ("ddm_model", "train_from_bags", "--config", config, "--out", "again.ddm", *made.bags)):
        code, output = call([find_program(words[0], package)] + words[1:], LIMIT_S, folder=str(tmp_path))
        assert code == 0, "%s\n%s" % (words, output)
        made.assert_unchanged(words)


def test_launches_that_read_a_run_leave_it_as_it_is(made, tmp_path):
    for launch in (["control.launch", "preset:=debug", "num_steps:=5", "model:=" + made.model],
                   ["record.launch", "preset:=debug", "num_steps:=5", "model:=" + made.model, "bag:=%s/new.bag" % tmp_path],
                   ["replay.launch", "preset:=debug", "model:=" + made.model, "bag:=" + made.bags[0], "rate:=0",
                    "out:=%s/replay.csv" % tmp_path]):
        _, output = roslaunch(str(tmp_path), *launch, limit_s=LIMIT_S)
        made.assert_unchanged(output)
        assert "process has finished cleanly" in output and "exit code" not in output


def test_a_finished_experiment_is_summed_up_and_stays_as_it_is(made, tmp_path):
    summary = os.path.join(made.run, "summary.yaml")
    before = made.before[summary][1]
    for start in (lambda: run_experiment(*made.experiment(made.run))[1],
                  lambda: roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "seed:=1", "trials:=1",
                                    "config:=" + made.config, "runs:=" + made.run)[1]):
        output = start()
        assert "2 models trained" in output, output
        assert os.stat(summary).st_mtime_ns > before  # demo.sh tells by it that this call found the experiment finished
        os.utime(summary, ns=(before, before))
        made.assert_unchanged(output)


def test_a_refused_experiment_leaves_the_run_as_it_is(made, tmp_path):
    folder = str(tmp_path / "run")
    shutil.copytree(made.run, folder)
    assert_refused("experiment/seed: 1 there, 2 here", folder, *made.experiment(folder, 2, 2))
    assert_refused("experiment/plant", folder, *made.experiment(folder, 1, 2), "--plant", "pendulum_gravity")
    bag = os.path.join(folder, "trial_000", "trial.bag")
    os.truncate(bag, os.path.getsize(bag) // 2)
    assert_refused(bag, folder, *made.experiment(folder, 1, 2))
    os.remove(bag)
    assert_refused(bag, folder, *made.experiment(folder, 1, 2))
    table = tmp_path / "run" / "trials.csv"
    table.write_text(table.read_text().replace("1", "2"))
    assert_refused("trials.csv", folder, *made.experiment(folder, 1, 2))


def test_a_refused_experiment_makes_no_folder(made, tmp_path):
    out, bag = str(tmp_path / "out"), tmp_path / "no.bag"
    bag.write_text("no bag")
    for word, more in (("windmill", ["--plant", "windmill"]), ("missing.ddm", ["--model", "missing.ddm"]),
                       ("no bag", ["--bags", str(bag)])):
        assert_refused(word, out, *made.experiment(out), *more)


def test_nodes_that_never_appear_leave_the_run_as_it_is_and_make_no_folder(made, tmp_path):
    config, new = tmp_path / "impatient.yaml", str(tmp_path / "new")
    config.write_text(QUICK + "experiment: {timeout: 2.0}\n")
    for runs in (made.run, new):
        _, output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "seed:=1", "trials:=2",
                              "config:=%s" % config, "runs:=" + runs, "simulator_here:=false")
        assert "REQUIRED process [experiment_node" in output and "exit code 1" in output
        made.assert_unchanged(output)
    assert not os.path.exists(new)
