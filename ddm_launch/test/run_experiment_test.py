# run_experiment: its files, repeatability with a seed, interruptions, and invalid inputs.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal

import pytest

from processes import Process, find_program, run_experiment
from run_files import COLUMNS, differences, expected_files, files_in, read_bag, read_bytes, read_rows, read_yaml

TRIALS = 2


def arguments(out, seed=1, trials=TRIALS):
    return ["--preset", "debug", "--seed", seed, "--trials", trials, "--out", out]


def run(out, *more, **values):
    """Runs an experiment that must succeed. Returns its output."""
    return run_experiment(*arguments(out, **values), *more)


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
        process = Process([find_program("run_experiment"), *arguments(out, trials=6)])
        process.waitForText("trial %2d/6" % finished, 120.0)
        process.send_signal(signal.SIGKILL)
        process.waitForEnd(60.0)
        assert "summary.yaml" not in files_in(out)
    assert "after trial" in run(out, trials=6)
    run(tmp_path / "uninterrupted", trials=6)
    assert differences(tmp_path / "uninterrupted", out, expected_files(6)) == []


def test_bad_options_are_refused_by_name_and_leave_no_folder(tmp_path):
    (tmp_path / "bad.yaml").write_text("mpc: {horzion: 3, epsilon: 1.5}\nplant: {dt: fast}\ntrial: {num_steps: 0}\n")
    (tmp_path / "real_time.yaml").write_text("sim: {lockstep: false}\n")
    (tmp_path / "robot.yaml").write_text("robot: {max_torque: 0.5}\n")
    out = str(tmp_path / "out")
    for words, more in (
            (["'--out'"], []), (["--nonsense"], ["--out", out, "--nonsense"]), (["positional"], ["--out", out, "paper"]),
            (["unknown preset 'papier'", "debug, efficient, paper, underactuated"], ["--out", out, "--preset", "papier"]),
            (["--seed", "99999999999"], ["--out", out, "--seed", "99999999999"]),
            (["--trials", "3x"], ["--out", out, "--trials", "3x"]),
            (["mpc/horzion", "horizon?", "mpc/epsilon", "1.5", "plant/dt", "fast", "trial/num_steps", "bad.yaml"],
             ["--out", out, "--config", tmp_path / "bad.yaml"]),
            (["missing.yaml"], ["--out", out, "--config", tmp_path / "missing.yaml"])):
        run_experiment(*more, code=2, words=words)
    run_experiment("--config", tmp_path / "real_time.yaml", *arguments(out), code=1, words=["sim/lockstep"])
    run_experiment("--config", tmp_path / "robot.yaml", *arguments(out), code=1, words=["robot.launch"])
    run_experiment(*arguments("/proc/ddm"), code=1, words=["cannot", "/proc/ddm"])
    assert not os.path.exists(out)
