# run_experiment: its files, repeatability with a seed, interruptions, and invalid inputs.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import signal
import time

import pytest

from processes import Process, find_program, roslaunch, run_experiment
from run_files import (COLUMNS, changes, differences, expected_files, files_in, fingerprint, read_bag, read_bytes, read_rows,
                       read_yaml)

TRIALS = 2


def arguments(out, seed=1, trials=TRIALS):
    return ["--preset", "debug", "--seed", seed, "--trials", trials, "--out", out]


def run(out, *more, **values):
    """Runs an experiment that must succeed. Returns its output."""
    code, output = run_experiment(*arguments(out, **values), *more)
    assert code == 0, output
    return output


def kill(condition, *more):
    """Kills an experiment as soon as condition(process) returns."""
    process = Process([find_program("run_experiment"), *more])
    condition(process)
    process.send(signal.SIGKILL)
    process.waitForEnd(60.0)


@pytest.fixture(name="reference", scope="module")
def make_reference(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("reference") / "run")
    run(folder)
    return folder


def test_all_files_of_the_contract_are_written_and_no_other(reference):
    assert files_in(reference) == expected_files(TRIALS)
    header, *rows = read_rows(reference, "trials.csv")
    assert header == COLUMNS
    assert [row[:3] for row in rows] == [["1", "0", "30"], ["1", "1", "60"], ["1", "2", "90"]]
    assert {row[-2] for row in rows} == {read_yaml(reference, "config.yaml")["version"]}
    summary = read_yaml(reference, "summary.yaml")
    assert summary["finished"] is True and summary["success"] == [int(row[3]) for row in rows]
    for k in range(TRIALS + 1):
        stamps = read_bag(os.path.join(reference, "trial_%03d" % k, "trial.bag"))
        assert len(stamps["camera/image_raw"]) == 30 and stamps["camera/image_raw"] == stamps["torque"]
        assert len(stamps["goal_image"]) == 1
        for kind, exploratory in (("trial", {"1"} if k == 0 else {"0", "1"}), ("evaluation", {"0"})):
            header, *rows = read_rows(reference, "%s_%03d" % (kind, k), "torques.csv")
            assert header == ["step", "torque_nm", "exploratory"]
            assert [row[0] for row in rows] == [str(step) for step in range(30)]
            assert all(abs(float(row[1])) <= 6.0 and "%.17g" % float(row[1]) == row[1] for row in rows)
            assert {row[2] for row in rows} <= exploratory
    header, *rows = read_rows(reference, "evaluation_000", "trajectory.csv")
    assert header == ["step", "time_s", "angle_rad", "rate_rad_per_s"]
    assert len(rows) == 30 and float(rows[-1][1]) == pytest.approx(29 * 0.2)


def test_a_seed_fixes_all_files_but_times(reference, tmp_path):
    run(tmp_path / "same")
    assert differences(reference, tmp_path / "same", expected_files(TRIALS)) == []
    run(tmp_path / "other", seed=2, trials=0)
    for name in ("trial_000/torques.csv", "evaluation_000/torques.csv"):
        assert read_bytes(reference, name) != read_bytes(tmp_path / "other", name)


def test_a_run_that_was_killed_goes_on_as_if_nothing_had_happened(tmp_path):
    out = str(tmp_path / "out")
    for finished in (0, 3):
        kill(lambda process: process.waitForText("trial %2d/6" % finished, 120.0), *arguments(out, trials=6))
        assert "summary.yaml" not in files_in(out)
    assert "after trial" in run(out, trials=6)
    run(tmp_path / "uninterrupted", trials=6)
    assert differences(tmp_path / "uninterrupted", out, expected_files(6)) == []


def test_a_run_that_was_killed_in_a_training_or_evaluation_does_not_repeat_the_recording(tmp_path):
    (tmp_path / "slow.yaml").write_text("training: {max_iterations: 1000, function_tolerance: 0.0}\n"
                                        "trial: {num_steps: 1000}\n")
    slow, out = ["--config", tmp_path / "slow.yaml"], str(tmp_path / "out")
    for trial, last, said in ((0, "torques.csv", "is recorded already"), (1, "training.yaml", "is trained already")):
        folder = os.path.join(out, "trial_%03d" % trial)

        def wait_for_last(process):
            while process.isRunning() and not os.path.exists(os.path.join(folder, last)):
                time.sleep(0.001)
        kill(wait_for_last, *slow, *arguments(out, trials=trial))
        before = read_bytes(folder, "trial.bag")
        assert said in run(out, *slow, trials=trial)
        assert read_bytes(folder, "trial.bag") == before
    run(tmp_path / "uninterrupted", *slow, trials=1)
    assert differences(tmp_path / "uninterrupted", out, expected_files(1)) == []


def test_the_same_command_leaves_a_finished_run_as_it_is_but_for_the_time_of_its_verdict(reference, tmp_path):
    out = str(tmp_path / "out")
    shutil.copytree(reference, out)
    before = fingerprint(out)
    assert "%d models trained" % (TRIALS + 1) in run(out)
    assert changes(before, fingerprint(out)) == [os.path.join(out, "summary.yaml")]
    assert differences(reference, out, expected_files(TRIALS)) == []


def test_a_saved_configuration_is_the_same_experiment_again_in_both_drivers(tmp_path):
    """In this experiment all values differ from the defaults, and it starts from a model and a bag."""
    before, original = tmp_path / "before", str(tmp_path / "original")
    (tmp_path / "more.yaml").write_text("mpc: {horizon: 4}\nplant: {friction: 0.02}\ncamera: {noise_std: 0.02}\n")
    run(before, "--plant", "pendulum_gravity", trials=0)
    run(original, "--plant", "pendulum_gravity", "--nuisance", "noise", "--nuisance", "delay", "--config", tmp_path / "more.yaml",
        "--model", before / "trial_000" / "model.ddm", "--bags", before / "trial_000" / "trial.bag", seed=5, trials=1)
    camera = read_yaml(original, "config.yaml")["camera"]
    assert (camera["noise_std"], camera["delay"], camera["clutter"]) == (0.02, 1, 0.0)
    again, nodes = str(tmp_path / "again"), str(tmp_path / "nodes")
    code, output = run_experiment("--repeat", original, "--out", again)
    assert code == 0, output
    _, output = roslaunch(str(tmp_path), "experiment.launch", "config:=original/config.yaml", "runs:=" + nodes,
                          folder=str(tmp_path))
    for folder in (again, nodes):
        # stamps in bags are another simulated time
        names = [name for name in expected_files(1) if not name.endswith(".bag")]
        assert differences(original, folder, names) == [], output
        assert read_yaml(folder, "config.yaml")["experiment"]["runs"] == folder


def test_bad_options_are_refused_by_name_and_leave_no_folder(tmp_path):
    (tmp_path / "bad.yaml").write_text("mpc: {horzion: 3, epsilon: 1.5}\nplant: {dt: fast}\ntrial: {num_steps: 0}\n")
    (tmp_path / "real_time.yaml").write_text("sim: {lockstep: false}\n")
    out = str(tmp_path / "out")
    for words, more in (
            (["'--out'"], []), (["--nonsense"], ["--out", out, "--nonsense"]), (["positional"], ["--out", out, "paper"]),
            (["unknown preset 'papier'", "debug, efficient, paper"], ["--out", out, "--preset", "papier"]),
            (["unknown plant 'sim'", "pendulum, pendulum_gravity"], ["--out", out, "--plant", "sim"]),
            (["unknown configuration 'nuisance/fog'", "nuisance/noise"], ["--out", out, "--nuisance", "fog"]),
            (["unknown method 'pilko'", "ddm, oracle"], ["--out", out, "--method", "pilko"]),
            (["experiment/trials", "1000"], ["--out", out, "--trials", "1000"]),
            (["--seed", "99999999999"], ["--out", out, "--seed", "99999999999"]),
            (["--trials", "3x"], ["--out", out, "--trials", "3x"]),
            (["mpc/horzion", "horizon?", "mpc/epsilon", "1.5", "plant/dt", "fast", "trial/num_steps", "bad.yaml"],
             ["--out", out, "--config", tmp_path / "bad.yaml"]),
            (["missing.yaml"], ["--out", out, "--config", tmp_path / "missing.yaml"])):
        code, output = run_experiment(*more)
        assert code == 2 and all(word in output for word in words), output
    code, output = run_experiment("--config", tmp_path / "real_time.yaml", *arguments(out))
    assert code != 0 and "sim/lockstep" in output
    code, output = run_experiment(*arguments("/proc/ddm"))
    assert code == 1 and "cannot" in output and "/proc/ddm" in output
    assert not os.path.exists(out)
